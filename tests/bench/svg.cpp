#include "tests/bench/svg.h"

#include <algorithm>
#include <cmath>
#include <fmt/core.h>
#include <fstream>

namespace cnc::bench {

namespace {

constexpr std::string_view kStyle = R"(<style>
text{font:12px sans-serif;fill:#222}
.axis{stroke:#888;stroke-width:1;fill:none}
.grid{stroke:#ddd;stroke-width:1}
.line{fill:none;stroke-width:1.6;stroke-linejoin:round}
.program{stroke:#555;fill:#555}.path{stroke:#0969da;fill:#0969da}.bound{stroke:#d1242f;fill:#d1242f}
.second{stroke:#1a7f37;fill:#1a7f37}.third{stroke:#9a6700;fill:#9a6700}
.tube{stroke:#8ab4e8;fill:#8ab4e8}
.band{fill:none;stroke:#8ab4e8;opacity:.35;stroke-linejoin:round;stroke-linecap:round}
.line.program,.line.path,.line.bound,.line.second,.line.third,.line.tube{fill:none}
@media (prefers-color-scheme:dark){text{fill:#ddd}.grid{stroke:#444}
.program{stroke:#bbb;fill:#bbb}.path{stroke:#58a6ff;fill:#58a6ff}.bound{stroke:#ff7b72;fill:#ff7b72}
.second{stroke:#56d364;fill:#56d364}.third{stroke:#e3b341;fill:#e3b341}}
</style>
)";

std::string_view name_of(Pen pen) {
  static constexpr std::string_view kNames[] = {"program", "path",  "bound",
                                                "second",  "third", "tube"};
  return kNames[static_cast<std::size_t>(pen)];
}

/// 1, 2 or 5 times a power of ten, so that about `count` of them fill the range.
double tick_of(Range range, double count) {
  const double wanted = (range.high - range.low) / count;
  const double power = std::pow(10.0, std::floor(std::log10(wanted)));
  for (const double step : {1.0, 2.0, 5.0}) {
    if (step * power >= wanted) return step * power;
  }
  return 10.0 * power;
}

/// Calls visit(value) for the ticks inside the range.
template <typename Visit>
void for_each_tick(Range range, double count, Visit visit) {
  const double tick = tick_of(range, count);
  const double first = std::ceil(range.low / tick - 1e-9);
  for (double i = first; i * tick <= range.high + 1e-9 * tick; ++i)
    visit(i == 0.0 ? 0.0 : i * tick);
}

double distance_from_line(const Dot& p, const Dot& a, const Dot& b) {
  const double length = std::hypot(b.x - a.x, b.y - a.y);
  if (length == 0.0) return std::hypot(p.x - a.x, p.y - a.y);
  return std::abs((b.x - a.x) * (p.y - a.y) - (b.y - a.y) * (p.x - a.x)) / length;
}

}  // namespace

Panel::Panel(const Frame& frame, Range x, Range y, std::string_view x_label,
             std::string_view y_label)
    : frame_(frame), x_(x), y_(y) {
  draw_axes(x_label, y_label);
}

double Panel::px(double x) const {
  return frame_.left + (x - x_.low) / (x_.high - x_.low) * frame_.width;
}

double Panel::py(double y) const {
  return frame_.top + (y_.high - y) / (y_.high - y_.low) * frame_.height;
}

void Panel::draw_axes(std::string_view x_label, std::string_view y_label) {
  const double bottom = frame_.top + frame_.height;
  const double right = frame_.left + frame_.width;
  for_each_tick(x_, frame_.width / 80.0, [&](double x) {
    axes_ +=
        fmt::format(R"(<line class="grid" x1="{0:.1f}" x2="{0:.1f}" y1="{1:.1f}" y2="{2:.1f}"/>)",
                    px(x), frame_.top, bottom);
    axes_ += fmt::format(R"(<text x="{:.1f}" y="{:.1f}" text-anchor="middle">{:.6g}</text>)", px(x),
                         bottom + 16.0, x);
  });
  for_each_tick(y_, frame_.height / 50.0, [&](double y) {
    axes_ +=
        fmt::format(R"(<line class="grid" y1="{0:.1f}" y2="{0:.1f}" x1="{1:.1f}" x2="{2:.1f}"/>)",
                    py(y), frame_.left, right);
    axes_ += fmt::format(R"(<text x="{:.1f}" y="{:.1f}" text-anchor="end">{:.6g}</text>)",
                         frame_.left - 6.0, py(y) + 4.0, y);
  });
  axes_ +=
      fmt::format(R"(<rect class="axis" x="{:.1f}" y="{:.1f}" width="{:.1f}" height="{:.1f}"/>)",
                  frame_.left, frame_.top, frame_.width, frame_.height);
  axes_ += fmt::format(R"(<text x="{:.1f}" y="{:.1f}" text-anchor="middle">{}</text>)",
                       frame_.left + 0.5 * frame_.width, bottom + 34.0, x_label);
  axes_ += fmt::format(R"(<text x="{:.1f}" y="{:.1f}">{}</text>)", frame_.left - 40.0,
                       frame_.top - 8.0, y_label);
  axes_ += '\n';
}

/// Leaves out what could not be seen: points that lie on the line between those that are kept.
std::string Panel::points_of(const Dots& dots) const {
  constexpr double kVisible = 0.15;
  constexpr std::size_t kMostLeftOut = 60;
  std::string text;
  std::vector<Dot> passed;  // since the last point kept, which is the first
  const auto keep = [&](const Dot& dot) {
    text += fmt::format("{:.1f},{:.1f} ", dot.x, dot.y);
    passed.assign(1, dot);
  };
  for (const Dot& dot : dots) {
    const Dot here{std::clamp(px(dot.x), -1000.0, 2000.0), std::clamp(py(dot.y), -1000.0, 2000.0)};
    if (passed.empty()) {
      keep(here);
      continue;
    }
    const bool straight = passed.size() < kMostLeftOut &&
                          std::all_of(passed.begin(), passed.end(), [&](const Dot& p) {
                            return distance_from_line(p, passed.front(), here) < kVisible;
                          });
    if (!straight) keep(passed.back());
    passed.push_back(here);
  }
  if (passed.size() > 1) keep(passed.back());
  return text;
}

void Panel::line(const Dots& dots, Pen pen) {
  drawn_ +=
      fmt::format("<polyline class=\"line {}\" points=\"{}\"/>\n", name_of(pen), points_of(dots));
}

void Panel::band(const Dots& dots, double width) {
  drawn_ += fmt::format("<polyline class=\"band\" stroke-width=\"{:.1f}\" points=\"{}\"/>\n",
                        width / (x_.high - x_.low) * frame_.width, points_of(dots));
}

void Panel::marks(const Dots& dots, Pen pen) {
  for (const Dot& dot : dots) {
    drawn_ += fmt::format("<circle class=\"{}\" cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"3.5\"/>\n",
                          name_of(pen), px(dot.x), py(dot.y));
  }
}

void Panel::legend(std::string_view text, Pen pen) {
  constexpr double kLetter = 6.4;  // about, of 12 px
  const double right = frame_.left + frame_.width - legend_width_;
  const double y = frame_.top - 8.0;
  legend_ += fmt::format(
      "<line class=\"line {0}\" x1=\"{1:.1f}\" x2=\"{2:.1f}\" y1=\"{3:.1f}\" y2=\"{3:.1f}\"/>"
      "<text x=\"{4:.1f}\" y=\"{5:.1f}\" text-anchor=\"end\">{6}</text>\n",
      name_of(pen), right - 20.0, right, y - 4.0, right - 26.0, y, text);
  legend_width_ += 44.0 + kLetter * static_cast<double>(text.size());
}

/// What is drawn ends at the frame; one clip for each panel, named after its place.
std::string Panel::body() const {
  const std::string clip = fmt::format("c{:.0f}_{:.0f}", frame_.left, frame_.top);
  return axes_ +
         fmt::format(
             "<clipPath id=\"{}\"><rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" "
             "height=\"{:.1f}\"/></clipPath>\n<g clip-path=\"url(#{})\">\n",
             clip, frame_.left, frame_.top, frame_.width, frame_.height, clip) +
         drawn_ + "</g>\n" + legend_;
}

bool save_svg(const std::string& file, double width, double height,
              const std::vector<Panel>& panels) {
  std::ofstream out(file);
  out << fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0:.0f} {1:.0f}\" "
      "width=\"{0:.0f}\" height=\"{1:.0f}\">\n",
      width, height);
  out << kStyle;
  for (const Panel& panel : panels) out << panel.body();
  out << "</svg>\n";
  return out.good();
}

}  // namespace cnc::bench
