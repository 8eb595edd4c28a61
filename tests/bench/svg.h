// Pictures for the documentation: panels with axes, drawn as SVG that is readable on a light and on
// a dark page.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace cnc::bench {

struct Dot {
  double x;
  double y;
};
using Dots = std::vector<Dot>;

struct Range {
  double low;
  double high;
};

/// A place in the picture, in pixels from its upper left corner.
struct Frame {
  double left;
  double top;
  double width;
  double height;
};

/// How something is drawn.
enum class Pen { program, path, bound, second, third, tube };

class Panel {
 public:
  Panel(const Frame& frame, Range x, Range y, std::string_view x_label, std::string_view y_label);

  void line(const Dots& dots, Pen pen);
  /// A line of `width` in units of the x axis.
  void band(const Dots& dots, double width);
  void marks(const Dots& dots, Pen pen);
  /// One more entry of the legend, which lies above the frame and grows to the left.
  void legend(std::string_view text, Pen pen);

  [[nodiscard]] std::string body() const;

 private:
  [[nodiscard]] double px(double x) const;
  [[nodiscard]] double py(double y) const;
  [[nodiscard]] std::string points_of(const Dots& dots) const;
  void draw_axes(std::string_view x_label, std::string_view y_label);

  Frame frame_;
  Range x_;
  Range y_;
  std::string axes_;
  std::string drawn_;
  std::string legend_;
  double legend_width_ = 0.0;
};

/// Writes the picture; false when that fails.
bool save_svg(const std::string& file, double width, double height,
              const std::vector<Panel>& panels);

}  // namespace cnc::bench
