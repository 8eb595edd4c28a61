// The pictures of docs/planner.md, drawn from what the planner does.
//
//   planner_pictures DIRECTORY CORPUS     writes DIRECTORY/*.svg; CORPUS holds 3D_Chips and others
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fmt/core.h>
#include <string>
#include <vector>

#include "motion/planner.h"
#include "tests/bench/path_program.h"
#include "tests/bench/svg.h"
#include "tests/motion/time_bound.h"

namespace {

using namespace cnc;
using namespace cnc::motion;
using bench::Dot;
using bench::Dots;
using bench::Panel;
using bench::Pen;

AxisLimits limits_of(double velocity, double acceleration) {
  return {Position::filled(velocity), Position::filled(acceleration)};
}

void save(const std::string& directory, const char* name, double width, double height,
          const std::vector<Panel>& panels) {
  const std::string file = fmt::format("{}/{}.svg", directory, name);
  if (bench::save_svg(file, width, height, panels)) return;
  fmt::print("cannot write {}\n", file);
  std::exit(1);
}

/// Calls visit(setpoint, cubics of X Y Z) for the whole motion.
template <typename Visit>
void for_each_setpoint(Planner& planner, Position& position, Position& velocity, Visit visit) {
  while (const auto setpoint = planner.next()) {
    visit(*setpoint);
    position = setpoint->position;
    velocity = setpoint->velocity;
  }
}

/// The path in X and Y that lines through `vertices` are driven on.
Dots path_through(const Dots& vertices, double feed, double tolerance, const AxisLimits& limits) {
  const auto position_of = [](const Dot& dot) {
    Position p;
    p[Axis::X] = dot.x;
    p[Axis::Y] = dot.y;
    return p;
  };
  Position position = position_of(vertices.front());
  Position velocity;
  Planner planner({.limits = limits}, position);
  MoveOptions options;
  options.feed = feed;
  options.tolerance = tolerance;
  for (const Dot& vertex : vertices) {
    if (!planner.add_line(position_of(vertex), options)) std::exit(1);
  }
  Dots path{vertices.front()};
  for_each_setpoint(planner, position, velocity, [&](const Setpoint& setpoint) {
    constexpr int kParts = 8;
    for (int i = 1; i <= kParts; ++i) {
      const double t = setpoint.duration * i / kParts;
      path.push_back({cubic_of(Axis::X, position, velocity, setpoint).position(t),
                      cubic_of(Axis::Y, position, velocity, setpoint).position(t)});
    }
  });
  return path;
}

void draw_corner(const std::string& directory) {
  const Dots program{{0, 0},  {4, 0.6},  {6, 2.2},  {6.7, 4.3}, {9.2, 4.6},
                     {10, 2}, {12, 1.4}, {12.6, 5}, {16, 5.2},  {20, 1}};
  Panel panel({56, 28, 720, 216}, {-0.5, 20.5}, {-0.6, 5.7}, "X, mm", "Y, mm");
  constexpr double kTolerance = 0.4;
  panel.band(program, 2.0 * kTolerance);
  panel.line(program, Pen::program);
  panel.marks(program, Pen::program);
  panel.line(path_through(program, 100.0, kTolerance, limits_of(100.0, 500.0)), Pen::path);
  panel.legend("program", Pen::program);
  panel.legend("tube of G64 P0.4", Pen::tube);
  panel.legend("path", Pen::path);
  save(directory, "tube", 800, 292, {panel});
}

void draw_square(const std::string& directory) {
  const Dots square{{5, 0}, {10, 0}, {10, 10}, {0, 10}, {0, 0}, {5, 0}};
  Panel whole({56, 28, 330, 330}, {-1, 11}, {-1, 11}, "X, mm", "Y, mm");
  Panel corner({452, 28, 330, 330}, {7.2, 10.4}, {7.2, 10.4}, "X, mm", "Y, mm");
  struct Row {
    double tolerance;
    Pen pen;
    const char* text;
  };
  for (const Row& row : {Row{1.0, Pen::bound, "P1"}, Row{0.5, Pen::third, "P0.5"},
                         Row{0.2, Pen::second, "P0.2"}, Row{0.1, Pen::path, "P0.1"}}) {
    const Dots path = path_through(square, 2000.0 / 60.0, row.tolerance, limits_of(50.0, 120.0));
    whole.line(path, row.pen);
    corner.line(path, row.pen);
    corner.legend(row.text, row.pen);
  }
  whole.line(square, Pen::program);
  corner.line(square, Pen::program);
  whole.legend("program", Pen::program);
  save(directory, "square", 800, 404, {whole, corner});
}

/// Highest speed of one line from rest to rest.
double speed_reached(double length, double feed, const AxisLimits& limits) {
  Planner planner({.limits = limits}, {});
  MoveOptions options;
  options.feed = feed;
  Position end;
  end[Axis::X] = length;
  if (!planner.add_line(end, options)) std::exit(1);
  Position position;
  Position velocity;
  double fastest = 0.0;
  for_each_setpoint(planner, position, velocity, [&](const Setpoint& setpoint) {
    fastest = std::max(fastest, cubic_of(Axis::X, position, velocity, setpoint).fastest());
  });
  return fastest;
}

void draw_distances(const std::string& directory) {
  // The manual's section 3.4.16: speed in mm/s and the length of a line that reaches it.
  const Dots manual{{19.20, 48}, {7.50, 30}, {5.21, 25}, {3.33, 20}, {2.41, 17},
                    {1.88, 15},  {1.20, 12}, {0.83, 10}, {0.68, 9},  {0.53, 8},
                    {0.41, 7},   {0.30, 6},  {0.21, 5},  {0.13, 4},  {0.08, 3}};
  Panel panel({56, 28, 720, 260}, {0, 20}, {0, 50}, "length of the line, mm",
              "highest speed, mm/s");
  Dots reached;
  for (double length = 0.02; length <= 20.0; length *= 1.04) {
    reached.push_back({length, speed_reached(length, 1000.0, limits_of(1000.0, 120.0))});
  }
  panel.line(reached, Pen::path);
  panel.marks(manual, Pen::bound);
  panel.legend("planner at 120 mm/s²", Pen::path);
  panel.legend("manual's table", Pen::bound);
  save(directory, "distances", 800, 336, {panel});
  fmt::print("| speed, mm/s | manual, mm | speed on that length |\n|---:|---:|---:|\n");
  for (const Dot& row : manual) {
    fmt::print("| {:.0f} | {:.2f} | {:.2f} |\n", row.y, row.x,
               speed_reached(row.x, 1000.0, limits_of(1000.0, 120.0)));
  }
}

struct Excerpt {
  const char* file;
  const char* title;
  double from;  ///< s
  double seconds;
};

/// A motion along the path: where it is when, and how fast.
struct Instant {
  double time;
  double way;
  double speed;
};
using Motion = std::vector<Instant>;

/// Speed over time during the excerpt.
Dots speed_of(const Motion& motion, const Excerpt& excerpt) {
  Dots dots;
  for (const Instant& now : motion) {
    const double time = now.time - excerpt.from;
    if (time >= 0.0 && time <= excerpt.seconds + 0.01) dots.push_back({time, now.speed});
  }
  return dots;
}

/// The speeds of `fast`, each at the time when `slow` is at that place.
Motion at_times_of(const Motion& slow, const Motion& fast) {
  Motion result;
  auto next = slow.begin();
  for (const Instant& now : fast) {
    while (next != slow.end() && next->way < now.way) ++next;
    if (next == slow.end()) break;
    double time = next->time;
    if (next != slow.begin() && next->way > (next - 1)->way) {
      const Instant& last = *(next - 1);
      time -= (next->way - now.way) / (next->way - last.way) * (next->time - last.time);
    }
    result.push_back({time, now.way, now.speed});
  }
  return result;
}

Panel draw_speed(const std::string& corpus, const Excerpt& excerpt, double top) {
  const bench::PathProgram program = bench::read_program(corpus + "/" + excerpt.file);
  const AxisLimits limits = limits_of(100.0, 500.0);
  Motion fastest;
  Motion driven;
  motion::test::TimeBound bound(limits, {}, 0.0005, [&](double time, double way, double speed) {
    fastest.push_back({time, way, speed});
  });
  Planner planner({.limits = limits}, {});
  double time = 0.0;
  double way = 0.0;
  Position position;
  Position velocity;
  const auto follow = [&](const Setpoint& setpoint) {
    constexpr int kParts = 4;
    for (int i = 1; i <= kParts; ++i) {
      double square = 0.0;
      for (const Axis axis : kLinearAxes) {
        const double v =
            cubic_of(axis, position, velocity, setpoint).velocity(setpoint.duration * i / kParts);
        square += v * v;
      }
      way += std::sqrt(square) * setpoint.duration / kParts;
      driven.push_back({time + setpoint.duration * i / kParts, way, std::sqrt(square)});
    }
    time += setpoint.duration;
    position = setpoint.position;
    velocity = setpoint.velocity;
  };
  bench::drive(planner, program, {.feed = 100.0, .tolerance = 0.02}, [&](Planner& from) {
    const auto setpoint = from.next();
    if (!setpoint) return;
    follow(*setpoint);
    bound.take(*setpoint);
  });
  const double least = bound.seconds();
  Panel panel({56, top, 720, 150}, {0, excerpt.seconds}, {0, 120}, "time, s",
              fmt::format("{}: speed, mm/s", excerpt.title));
  panel.line(speed_of(at_times_of(driven, fastest), excerpt), Pen::bound);
  panel.line(speed_of(driven, excerpt), Pen::path);
  panel.legend(fmt::format("planner, {:.2f} s in all", time), Pen::path);
  panel.legend(fmt::format("fastest along the same path, {:.2f} s", least), Pen::bound);
  return panel;
}

void draw_speeds(const std::string& directory, const std::string& corpus) {
  const Excerpt excerpts[] = {{"linuxcnc--3D_Chips.ngc", "3D_Chips", 20.0, 2.0},
                              {"nraynaud--tux.ngc", "tux", 20.0, 2.0},
                              {"Sienci-Labs--SheepTile-v2.nc", "SheepTile", 90.0, 2.0}};
  std::vector<Panel> panels;
  double top = 28.0;
  for (const Excerpt& excerpt : excerpts) {
    panels.push_back(draw_speed(corpus, excerpt, top));
    top += 220.0;
  }
  save(directory, "speed", 800, top - 20.0, panels);
}

}  // namespace

int main(int count, char** values) {
  if (count != 3) {
    fmt::print("usage: planner_pictures DIRECTORY CORPUS\n");
    return EXIT_FAILURE;
  }
  const std::string directory = values[1];
  draw_corner(directory);
  draw_square(directory);
  draw_distances(directory);
  draw_speeds(directory, values[2]);
}
