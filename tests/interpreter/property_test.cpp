// Properties of the language that hold for any program: random ones, the same in every run.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <numbers>
#include <random>

#include "tests/interpreter/support.h"

using namespace cnc;
using namespace cnc::interp;
using namespace cnc::interp::test;

namespace {

class Random {
 public:
  explicit Random(std::uint32_t seed) : engine_(seed) {}

  bool chance(double probability) { return std::bernoulli_distribution(probability)(engine_); }
  int whole(int lowest, int highest) {
    return std::uniform_int_distribution(lowest, highest)(engine_);
  }
  double real(double lowest, double highest) {
    return std::uniform_real_distribution(lowest, highest)(engine_);
  }
  template <typename T>
  const T& one_of(const std::vector<T>& values) {
    return values[static_cast<std::size_t>(whole(0, static_cast<int>(values.size()) - 1))];
  }
  template <typename T>
  void shuffle(std::vector<T>& values) {
    std::shuffle(values.begin(), values.end(), engine_);
  }

 private:
  std::mt19937 engine_;
};

using Words = std::vector<std::string>;

std::string line_of(const Words& words) { return fmt::format("{}\n", fmt::join(words, " ")); }

/// A line that means something: at most one item of each kind of table 3-7. Behind "F100".
Words random_line(Random& random) {
  static const std::vector<std::vector<Words>> kKinds{
      {{"(note)"}, {"(MSG, hello)"}},
      {{"#9=3"}, {"#9=#8"}, {"#[4+4]=[#9*2]"}},
      {{"G94", "F200"}, {"F50"}, {"G95", "M3", "F0.5"}},
      {{"S500"}, {"S[100*2]"}},
      {{"T3"}},
      {{"M3"}, {"M4"}, {"M5"}},
      {{"M7"}, {"M8"}, {"M9"}},
      {{"M48"}, {"M49"}, {"M51", "P80"}},
      {{"G4", "P1"}},
      {{"G20"}, {"G21"}},
      {{"G40"}},
      {{"G49"}, {"G43.1", "K5"}, {"G43", "H2"}},
      {{"G54"}, {"G55"}, {"G59.3"}},
      {{"G61"}, {"G64", "Q0.01"}, {"G61.1"}},
      {{"G90"}, {"G91"}},
      {{"G98"}, {"G99"}},
      {{"G92.1"}, {"G92.2"}, {"G53"}},
      {{"G0", "X5", "Y-3"},
       {"G1", "Z1.5", "A20"},
       {"G2", "X1", "Y1", "R50"},
       {"G3", "X#9", "I3"},
       {"G81", "X4", "Z-1", "R7", "L2"},
       {"G83", "Z-2", "R9", "Q1"},
       {"X7"},
       {"G80"}},
      {{"M54", "P1"}, {"M55", "P[1+1]"}},
  };
  Words line;
  for (const std::vector<Words>& kind : kKinds) {
    if (!random.chance(0.25)) continue;
    const Words& words = random.one_of(kind);
    line.insert(line.end(), words.begin(), words.end());
  }
  return line;
}

/// Everything that a program did. Of two errors on a line the first is told, so only that there is
/// one counts.
std::string trace_of(const Outcome& outcome) {
  return fmt::format("{}\n{}\n{}", fmt::join(outcome.lines, "\n"), outcome.modal.active_codes(),
                     outcome.failed ? "refused" : "");
}

}  // namespace

TEST_CASE("The words of a line may stand in any order", "[GCO-1]") {
  // Manual 3.2.6: words, settings and comments may be reordered and interleaved.
  Random random(1);
  int executed = 0;
  for (int round = 0; round < 2000; ++round) {
    Words words = random_line(random);
    const auto trace = [&] {
      Bench bench;
      const Outcome outcome = bench.run("F100 G0 X1 Y1 Z8\n" + line_of(words) + "G0 X2\n");
      executed += outcome.failed ? 0 : 1;
      return trace_of(outcome) +
             fmt::format("{} {}", bench.parameters.get(8), bench.parameters.get(9));
    };
    const std::string expected = trace();
    for (int order = 0; order < 3; ++order) {
      random.shuffle(words);
      INFO(line_of(words));
      REQUIRE(trace() == expected);
    }
  }
  // Refused lines prove little: most of them run.
  CHECK(executed > 4000);
}

namespace {

/// A part of straight lines, arcs and holes, written in either unit.
class RandomPart {
 public:
  RandomPart(std::uint32_t seed, double unit) : random_(seed), unit_(unit) {
    text_ = unit == 1.0 ? "G21\n" : "G20\n";
    add("F{}\n", length(600));
  }

  std::string text() {
    for (int line = 0; line < 40; ++line) add_line();
    return text_ + "M30\n";
  }

 private:
  template <typename... Arguments>
  void add(fmt::format_string<Arguments...> format, Arguments&&... arguments) {
    text_ += fmt::format(format, std::forward<Arguments>(arguments)...);
  }
  /// `mm` in the unit of the program, with all its digits.
  std::string length(double mm) const { return fmt::format("{:.17f}", mm / unit_); }
  std::string random_length() { return length(random_.real(-200, 200)); }

  void add_line() {
    switch (random_.whole(0, 9)) {
      case 0:
        return add("G0 X{} Y{} Z{}\n", random_length(), random_length(), random_length());
      case 1:
        return add("G1 X{} F{}\n", random_length(), length(random_.real(1, 2000)));
      case 2:
        return add("G91 G1 X{} Y{}\nG90\n", random_length(), random_length());
      case 3:
        return add_circle();
      case 4:
        return add("G0 X0 Y0\nG2 X{0} Y{0} R{1}\n", length(10), length(25));
      case 5:
        return add("G98 G81 X{} Z{} R{}\nG80\n", random_length(), length(-5), length(3));
      case 6:
        return add("G92 X{} Z{}\n", random_length(), random_length());
      case 7:
        return add("G10 L2 P2 Y{}\nG{}\n", random_length(), random_.whole(54, 55));
      case 8:
        return add("G43.1 K{}\nG0 Z{}\n", length(random_.real(0, 50)), length(100));
      default:
        return add("G68 R{} X{}\nG0 X{}\nG69\n", random_.whole(0, 90), length(3), length(7));
    }
  }

  /// A half turn around (I, J).
  void add_circle() {
    const double radius = random_.real(1, 50);
    const double angle = random_.real(0, 2 * std::numbers::pi);
    const double i = radius * std::cos(angle);
    const double j = radius * std::sin(angle);
    add("G91 G3 X{} Y{} I{} J{} Z{}\nG90\n", length(2 * i), length(2 * j), length(i), length(j),
        length(1));
  }

  Random random_;
  double unit_;
  std::string text_;
};

/// End points and centres of all moves, and the feeds.
std::vector<double> numbers_of(const std::string& text) {
  std::vector<double> numbers;
  CheckOptions options;
  options.sink = [&](const Command& command) {
    std::visit(
        [&]<typename Body>(const Body& body) {
          if constexpr (requires { Position{body.end}; }) {
            for (const Axis axis : kAllAxes) numbers.push_back(body.end[axis]);
          }
          if constexpr (std::is_same_v<Body, ArcMove>) {
            numbers.push_back(body.first_centre);
            numbers.push_back(body.second_centre);
          }
          if constexpr (std::is_same_v<Body, SetFeedRate>) numbers.push_back(body.feed);
        },
        command.body);
  };
  const CheckReport report =
      check(Program::from_text(text, "part.nc").value(), {}, {}, {}, {}, options);
  for (const Diagnostic& error : report.errors) FAIL(error.to_string() << text);
  return numbers;
}

}  // namespace

TEST_CASE("A part written in inches is cut as the same part in millimetres", "[GCO-1][GCO-2]") {
  for (std::uint32_t seed = 1; seed <= 200; ++seed) {
    INFO("part " << seed);
    const auto metric = numbers_of(RandomPart(seed, 1.0).text());
    const auto inches = numbers_of(RandomPart(seed, 25.4).text());
    REQUIRE(metric.size() > 100);
    REQUIRE(inches.size() == metric.size());
    for (std::size_t i = 0; i < metric.size(); ++i) {
      const double allowed = 1e-9 * std::max(1.0, std::abs(metric[i]));
      REQUIRE(std::abs(inches[i] - metric[i]) <= allowed);
    }
  }
}

namespace {

/// A program with a loop and a sub, that waits for nobody.
std::string random_program(Random& random) {
  std::string text = "F100 M3 S100\n";
  const auto add_lines = [&](int count) {
    while (count > 0) {
      const std::string line = line_of(random_line(random));
      const bool is_plain = line.find("G20") == line.npos && line.find("(") == line.npos;
      if (!is_plain || run("F100 M3 S100\n" + line).failed) continue;
      text += line;
      --count;
    }
  };
  add_lines(5);
  text += "#1=0\nwhile [#1 < 3]\n#1=[#1+1]\n";
  add_lines(2);
  text += "if [#1 == 2]\ngosub a\nelse\n";
  add_lines(1);
  text += "endif\nendwhile\n";
  add_lines(5);
  text += "M30\nsub a\n";
  add_lines(2);
  return text + "endsub\n";
}

struct Traced {
  std::uint32_t line;
  std::string text;
  friend bool operator==(const Traced&, const Traced&) = default;
};

/// The commands that are still to come.
std::vector<Traced> rest_of(Interpreter& interpreter) {
  std::vector<Traced> rest;
  for (;;) {
    const Progress progress = interpreter.next();
    if (progress == Progress::waiting) interpreter.answer(interpreter.expected_answer());
    if (progress == Progress::command) {
      rest.push_back({interpreter.command().source.line, interp::text_of(interpreter.command())});
    }
    if (progress == Progress::ended || progress == Progress::failed) return rest;
  }
}

}  // namespace

TEST_CASE("A search leaves what a run would still have done", "[JOB-3]") {
  Random random(3);
  int searches = 0;
  for (int round = 0; round < 60; ++round) {
    const std::string text = random_program(random);
    const auto program = Program::from_text(text, "job.nc").value();
    Bench whole;
    Interpreter runs(whole.settings, whole.parameters, whole.tools);
    runs.start(program, {});
    const std::vector<Traced> all = rest_of(runs);
    for (std::uint32_t line = 2; line < program->line_count(); ++line) {
      Bench bench;
      Interpreter interpreter(bench.settings, bench.parameters, bench.tools);
      interpreter.start(program, {}, {.mode = RunMode::search, .search_line = line});
      Progress progress = interpreter.next();
      while (progress == Progress::working) progress = interpreter.next();
      if (progress != Progress::found) continue;  // the program fails before, or never gets there
      ++searches;
      const ResumePoint point = interpreter.resume_point();
      interpreter.leave_search(point.position);
      const std::vector<Traced> rest = rest_of(interpreter);
      INFO("line " << line << " of\n" << text);
      REQUIRE(rest.size() <= all.size());
      const auto begin = all.end() - static_cast<std::ptrdiff_t>(rest.size());
      REQUIRE(std::equal(rest.begin(), rest.end(), begin));
      // It was the first time that the line came.
      REQUIRE(std::none_of(all.begin(), begin,
                           [&](const Traced& command) { return command.line == line; }));
    }
  }
  CHECK(searches > 500);
}
