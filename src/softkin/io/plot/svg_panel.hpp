#pragma once

#include <softkin/io/plot/svg_axis.hpp>
#include <softkin/io/plot/svg_canvas.hpp>
#include <softkin/io/plot/svg_plot.hpp>

namespace softkin {

/// One panel of a plot: title, legend, frame with ticks, labels, series. panel must outlive it and be checked.
class SvgPanel {
 public:
  /// Of the parts from above [pixel].
  struct Heights {
    double title = 0, legend = 0, frame = 0, below = 0;

    void cover(const Heights& other);
    [[nodiscard]] double all() const { return title + legend + frame + below; }
  };

  SvgPanel(const PlotPanel& panel, double width, double frame_height);

  /// What the panel needs.
  [[nodiscard]] Heights heights() const { return heights_; }
  [[nodiscard]] double width() const { return width_; }

  /// Takes the heights of its row: frames of a row stand side by side.
  void correct(const Heights& heights);
  /// corner: upper left. number: of the panel in the plot.
  void draw(SvgCanvas& canvas, SvgPoint corner, int number) const;

 private:
  struct Entry {  // of the legend
    std::size_t series = 0;
    std::string text;
    double x = 0;
    int line = 0;
  };

  void arrange_legend();
  void arrange_axes();
  void equalize();
  void find_x_ticks();
  void find_y_ticks();
  [[nodiscard]] double frame_width() const { return width_ - left_ - right_; }
  [[nodiscard]] int style_of(std::size_t series) const;
  [[nodiscard]] SvgStroke stroke_of(std::size_t series) const;
  void draw_title(SvgCanvas& canvas, SvgPoint corner) const;
  void draw_legend(SvgCanvas& canvas, SvgPoint corner) const;
  void draw_axes(SvgCanvas& canvas, SvgPoint low, SvgPoint high) const;
  void draw_series(SvgCanvas& canvas, SvgPoint low, SvgPoint high, int number) const;

  const PlotPanel& panel_;
  double width_;
  double left_ = 0, right_ = 0;  // beside the frame [pixel]
  Heights heights_;
  AxisRange x_range_, y_range_;
  AxisTicks x_ticks_, y_ticks_;
  std::vector<Entry> legend_;
};

}  // namespace softkin
