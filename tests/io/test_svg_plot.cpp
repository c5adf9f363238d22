#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <pugixml.hpp>
#include <set>
#include <softkin/core/error.hpp>
#include <softkin/io/plot/svg_axis.hpp>
#include <softkin/io/plot/svg_plot.hpp>
#include <sstream>

namespace softkin {
namespace {

using Pairs = std::vector<std::pair<double, double>>;

/// The linear map from values to pixels, as read from the ticks of an axis.
struct Scale {
  double first_value = 0, first_pixel = 0, last_value = 0, last_pixel = 0;

  [[nodiscard]] double at(double value) const {
    return first_pixel + (value - first_value) / (last_value - first_value) * (last_pixel - first_pixel);
  }
};

class Drawing {
 public:
  explicit Drawing(const Plot& plot) : text(svg_text(plot)) {
    const pugi::xml_parse_result result = xml_.load_string(text.c_str());
    EXPECT_TRUE(result) << result.description();
    for (const pugi::xml_node panel : root().children("g"))
      if (kind(panel) == "panel") panels.push_back(panel);
  }

  [[nodiscard]] pugi::xml_node root() const { return xml_.child("svg"); }

  static std::string kind(pugi::xml_node node) { return node.attribute("class").value(); }

  static std::vector<pugi::xml_node> groups(pugi::xml_node panel, const std::string& name) {
    std::vector<pugi::xml_node> found;
    for (const pugi::xml_node group : panel.children("g"))
      if (kind(group) == name) found.push_back(group);
    return found;
  }

  /// Texts of the ticks with the pixel of each tick.
  static std::vector<std::pair<std::string, double>> ticks(pugi::xml_node panel, bool along_x) {
    std::vector<std::pair<std::string, double>> ticks;
    const pugi::xml_node axis = groups(panel, along_x ? "x-axis" : "y-axis").at(0);
    for (const pugi::xml_node line : axis.children("line"))
      if (line.next_sibling().name() == std::string("text"))
        ticks.emplace_back(line.next_sibling().child_value(), line.attribute(along_x ? "x1" : "y1").as_double());
    return ticks;
  }

  static Scale scale(pugi::xml_node panel, bool along_x) {
    const auto all = ticks(panel, along_x);
    EXPECT_GE(all.size(), 2u);
    return {std::stod(all.front().first), all.front().second, std::stod(all.back().first), all.back().second};
  }

  static Pairs line(pugi::xml_node panel, std::size_t series) {
    std::istringstream stream(groups(panel, "series").at(series).child("polyline").attribute("points").value());
    Pairs points;
    char comma = 0;
    for (double x = 0, y = 0; stream >> x >> comma >> y;) points.emplace_back(x, y);
    return points;
  }

  /// Number of marks: each begins with one "M", crosses and pluses with two.
  static std::size_t marks(pugi::xml_node panel, std::size_t series) {
    const std::string d = groups(panel, "series").at(series).child("path").attribute("d").value();
    const auto count = [&](char c) { return static_cast<std::size_t>(std::count(d.begin(), d.end(), c)); };
    return count('Z') > 0 ? count('Z') : count('M') / 2;
  }

  static pugi::xml_node frame(pugi::xml_node panel) {
    for (const pugi::xml_node rect : panel.children("rect"))
      if (kind(rect) == "frame") return rect;
    return {};
  }

  std::string text;
  std::vector<pugi::xml_node> panels;

 private:
  pugi::xml_document xml_;
};

PlotSeries series(const std::string& label, std::vector<double> x, std::vector<double> y) {
  PlotSeries result;
  result.label = label;
  result.x = std::move(x);
  result.y = std::move(y);
  return result;
}

Plot plot_of(std::vector<PlotSeries> all) {
  PlotPanel panel;
  panel.title = "panel";
  panel.x.label = "time [s]";
  panel.y.label = "error [mm]";
  panel.series = std::move(all);
  Plot plot;
  plot.title = "title";
  plot.rows = {{panel}};
  return plot;
}

void expect_refused(const Plot& plot, const std::string& part) {
  try {
    (void)svg_text(plot);
    ADD_FAILURE() << "not refused: " << part;
  } catch (const InvalidInput& error) {
    EXPECT_NE(std::string(error.what()).find(part), std::string::npos) << error.what();
  }
}

TEST(SvgPlot, PointsStandWhereTheTicksSay) {
  const std::vector<double> x{0.3, 1.7, 4.25, 9.1}, y{-12.5, 40, 3.2, 77.7};
  const Drawing drawing(plot_of({series("a", x, y), series("b", y, x)}));
  const pugi::xml_node panel = drawing.panels.at(0);
  const Scale across = Drawing::scale(panel, true), up = Drawing::scale(panel, false);
  for (const bool swapped : {false, true}) {
    const Pairs points = Drawing::line(panel, swapped ? 1 : 0);
    ASSERT_EQ(points.size(), x.size());
    for (std::size_t i = 0; i < x.size(); ++i) {
      EXPECT_NEAR(points[i].first, across.at(swapped ? y[i] : x[i]), 0.05);
      EXPECT_NEAR(points[i].second, up.at(swapped ? x[i] : y[i]), 0.05);
    }
  }
  EXPECT_GT(up.first_pixel, up.last_pixel);  // upwards
  EXPECT_LT(across.first_pixel, across.last_pixel);
}

TEST(SvgPlot, EveryPointIsInsideTheFrameAndEveryTextInsideThePicture) {
  const Drawing drawing(plot_of({series("a", {-1e6, 2e6, 123456}, {1e-7, -3e-7, 9e-8})}));
  const pugi::xml_node frame = Drawing::frame(drawing.panels.at(0));
  const double left = frame.attribute("x").as_double(), top = frame.attribute("y").as_double();
  for (const auto& [x, y] : Drawing::line(drawing.panels.at(0), 0)) {
    EXPECT_GE(x, left);
    EXPECT_LE(x, left + frame.attribute("width").as_double());
    EXPECT_GE(y, top);
    EXPECT_LE(y, top + frame.attribute("height").as_double());
  }
  for (const auto& found : drawing.root().select_nodes(".//text")) {
    const pugi::xml_node text = found.node();
    const std::string anchor = text.attribute("text-anchor").value();
    const double width = 0.6 * text.attribute("font-size").as_double() * double(std::string(text.child_value()).size());
    const double x = text.attribute("x").as_double();
    if (std::string(text.attribute("transform").value()).empty()) {
      EXPECT_GE(x - (anchor == "end" ? width : anchor == "middle" ? width / 2 : 0), 0) << text.child_value();
      EXPECT_LE(x + (anchor == "end"      ? 0
                     : anchor == "middle" ? width / 2
                                          : width),
                drawing.root().attribute("width").as_double())
          << text.child_value();
    }
    EXPECT_LE(text.attribute("y").as_double(), drawing.root().attribute("height").as_double());
  }
}

TEST(SvgPlot, RowsAndPanelsDoNotOverlap) {
  Plot plot = plot_of({series("a", {0, 1}, {0, 1})});
  plot.rows.push_back({plot.rows[0][0], plot.rows[0][0], plot.rows[0][0]});
  for (PlotPanel& panel : plot.rows[1]) panel.equal = true;
  const Drawing drawing(plot);
  ASSERT_EQ(drawing.panels.size(), 4u);
  std::vector<pugi::xml_node> frames;
  for (const pugi::xml_node& panel : drawing.panels) frames.push_back(Drawing::frame(panel));
  for (int i = 1; i < 4; ++i)
    EXPECT_GT(frames[std::size_t(i)].attribute("y").as_double(),
              frames[0].attribute("y").as_double() + frames[0].attribute("height").as_double() + 30);
  for (std::size_t i = 1; i < 3; ++i) {
    EXPECT_GT(frames[i + 1].attribute("x").as_double(),
              frames[i].attribute("x").as_double() + frames[i].attribute("width").as_double() + 30);
    EXPECT_EQ(frames[i + 1].attribute("y").as_double(), frames[i].attribute("y").as_double());
  }
}

TEST(SvgPlot, AMillimetreIsAsLongInBothDirectionsWhereAsked) {
  for (const auto& [x, y] : {std::pair{Pairs{{0, 0}, {100, 3}}, 0.0}, std::pair{Pairs{{0, 0}, {3, 100}}, 0.0},
                             std::pair{Pairs{{5, 120}, {9, 120}}, 0.0}, std::pair{Pairs{{7, 1}}, 0.0}}) {
    (void)y;
    PlotSeries path = series("path", {}, {});
    for (const auto& point : x) {
      path.x.push_back(point.first);
      path.y.push_back(point.second);
    }
    Plot plot = plot_of({path});
    plot.rows[0][0].equal = true;
    const Drawing drawing(plot);
    const Scale across = Drawing::scale(drawing.panels[0], true), up = Drawing::scale(drawing.panels[0], false);
    const double along_x = (across.last_pixel - across.first_pixel) / (across.last_value - across.first_value);
    const double along_y = (up.first_pixel - up.last_pixel) / (up.last_value - up.first_value);
    EXPECT_NEAR(along_x / along_y, 1, 2e-3);
    const double extent =
        x.size() > 1 ? std::max(std::abs(x[1].first - x[0].first), std::abs(x[1].second - x[0].second)) : 0;
    EXPECT_GT(extent * along_x, x.size() > 1 ? 100 : -1);  // the path is not lost in its frame
  }
}

TEST(SvgPlot, LogarithmicAxesHaveDecades) {
  Plot plot = plot_of({series("a", {0, 1, 2, 3}, {1e-8, 3e-5, 0.02, 4})});
  plot.rows[0][0].y.logarithmic = true;
  const Drawing drawing(plot);
  const auto ticks = Drawing::ticks(drawing.panels[0], false);
  ASSERT_GE(ticks.size(), 2u);
  const double decade =
      (ticks[0].second - ticks[1].second) / std::log10(std::stod(ticks[1].first) / std::stod(ticks[0].first));
  const Pairs points = Drawing::line(drawing.panels[0], 0);
  const std::vector<double> y{1e-8, 3e-5, 0.02, 4};
  for (std::size_t i = 0; i < y.size(); ++i)
    EXPECT_NEAR(points[i].second, ticks[0].second - decade * std::log10(y[i] / std::stod(ticks[0].first)), 0.1);
  for (const auto& [label, pixel] : ticks) {
    const double power = std::log10(std::stod(label));
    EXPECT_NEAR(power, std::round(power), 1e-12) << label;
  }
}

TEST(SvgPlot, DegenerateDataAreDrawn) {
  for (const std::vector<PlotSeries>& all : {std::vector<PlotSeries>{series("one", {3}, {4})},
                                             {series("constant", {0, 1, 2}, {0.1, 0.1, 0.1 + 1e-17})},
                                             {series("zero", {0, 0}, {0, 0})},
                                             {series("none", {}, {})},
                                             std::vector<PlotSeries>{}}) {
    const Drawing drawing(plot_of(all));
    for (const bool along_x : {true, false}) {
      const auto ticks = Drawing::ticks(drawing.panels.at(0), along_x);
      EXPECT_GE(ticks.size(), 2u);
      std::set<std::string> labels;
      for (const auto& [label, pixel] : ticks) labels.insert(label);
      EXPECT_EQ(labels.size(), ticks.size());
    }
    EXPECT_EQ(drawing.text.find("nan"), std::string::npos);
    EXPECT_EQ(drawing.text.find("inf"), std::string::npos);
  }
  const Drawing one(plot_of({series("one", {3}, {4})}));
  EXPECT_EQ(Drawing::marks(one.panels[0], 0), 1u);  // a line of one point is a mark
}

TEST(SvgPlot, TextsAreEscaped) {
  Plot plot = plot_of({series("<b> & \"c\"", {0, 1}, {0, 1})});
  plot.title = "a < b && </svg><script>x</script>";
  plot.rows[0][0].title = "bad \xFF\x01 and ok \xC3\xA9";
  plot.rows[0][0].y.label = "two\nlines";
  const Drawing drawing(plot);
  EXPECT_EQ(drawing.root().child("title").child_value(), plot.title);
  std::set<std::string> texts;
  for (const auto& found : drawing.root().select_nodes(".//text")) texts.insert(found.node().child_value());
  EXPECT_TRUE(texts.count("<b> & \"c\""));
  EXPECT_TRUE(texts.count("bad ?? and ok \xC3\xA9"));
  EXPECT_TRUE(texts.count("two lines"));
  EXPECT_FALSE(drawing.root().child("script"));
  for (const char* foreign : {"href", "http://www.w3.org/1999", "@import", "<script", "url(http"})
    EXPECT_EQ(drawing.text.find(foreign), std::string::npos);
}

TEST(SvgPlot, LongTextsAreCut) {
  Plot plot = plot_of({series(std::string(400, 'w'), {0, 1}, {0, 1})});
  plot.title = std::string(1000, 'm');
  const Drawing drawing(plot);
  for (const auto& found : drawing.root().select_nodes(".//text")) {
    const std::string text = found.node().child_value();
    EXPECT_LT(double(text.size()) * 0.7 * found.node().attribute("font-size").as_double(), plot.width);
  }
}

TEST(SvgPlot, SeriesDifferWithoutColours) {
  std::vector<PlotSeries> all;
  for (int i = 0; i < 6; ++i) all.push_back(series("s" + std::to_string(i), {0, 1}, {double(i), double(i)}));
  const Drawing drawing(plot_of(all));
  std::set<std::string> dashes, shapes;
  for (const pugi::xml_node group : Drawing::groups(drawing.panels[0], "series")) {
    dashes.insert(group.child("polyline").attribute("stroke-dasharray").value());
    std::string shape;  // without the places
    for (const char c : std::string(group.child("path").attribute("d").value()))
      if (std::isalpha(static_cast<unsigned char>(c))) shape += c;
    shapes.insert(shape + group.child("path").attribute("d").value());
  }
  EXPECT_EQ(dashes.size(), 6u);
  EXPECT_EQ(shapes.size(), 6u);
  const auto legend = Drawing::groups(drawing.panels[0], "legend");
  EXPECT_EQ(std::distance(legend[0].children("text").begin(), legend[0].children("text").end()), 6);
}

TEST(SvgPlot, PairsAreJoinedOneByOneAndPaleLinesAreGrey) {
  PlotSeries gaps = series("gaps", {0, 1, 4, 5, 9}, {0, 2, 0, 3, 9}), below = series("below", {0, 9}, {1, 1});
  gaps.pairs = true;
  gaps.marks = false;
  below.pale = true;
  const Drawing drawing(plot_of({gaps, below}));
  const auto groups = Drawing::groups(drawing.panels[0], "series");
  const std::string d = groups[0].child("path").attribute("d").value();
  EXPECT_EQ(std::count(d.begin(), d.end(), 'M'), 2);  // the fifth point has no partner
  EXPECT_EQ(std::count(d.begin(), d.end(), 'L'), 2);
  EXPECT_FALSE(groups[0].child("polyline"));
  const std::string grey = groups[1].child("polyline").attribute("stroke").value();
  EXPECT_EQ(grey.substr(1, 2), grey.substr(3, 2));
  EXPECT_EQ(grey.substr(3, 2), grey.substr(5, 2));
  EXPECT_FALSE(groups[1].child("polyline").attribute("stroke-dasharray"));
}

TEST(SvgPlot, EndsOfAxesThatAreGivenHold) {
  Plot plot = plot_of({series("a", {0, 10}, {0, 10})});
  plot.rows[0][0].x.low = 2;
  plot.rows[0][0].x.high = 4;
  const Drawing drawing(plot);
  const Scale across = Drawing::scale(drawing.panels[0], true);
  const pugi::xml_node frame = Drawing::frame(drawing.panels[0]);
  EXPECT_NEAR(across.at(2), frame.attribute("x").as_double(), 0.05);
  EXPECT_NEAR(across.at(4), frame.attribute("x").as_double() + frame.attribute("width").as_double(), 0.05);
  const std::string clip = Drawing::groups(drawing.panels[0], "series")[0].attribute("clip-path").value();
  EXPECT_EQ(clip, "url(#frame0)");  // curves are clipped at the frame
  EXPECT_STREQ(drawing.panels[0].child("clipPath").attribute("id").value(), "frame0");
}

TEST(SvgPlot, LongSeriesStaySmallAndKeepTheirSpikes) {
  constexpr int count = 1'000'000, spike = 654'321;
  PlotSeries wave = series("wave", {}, {}), cloud = series("cloud", {}, {});
  for (int i = 0; i < count; ++i) {
    wave.x.push_back(i);
    wave.y.push_back(i == spike ? 50 : std::sin(1e-5 * i));
  }
  cloud.line = false;
  for (int i = 0; i < 200'000; ++i) {
    cloud.x.push_back(count * std::fmod(0.754877666 * i, 1));
    cloud.y.push_back(50 * std::fmod(0.569840291 * i, 1));
  }
  const Drawing drawing(plot_of({wave, cloud}));
  EXPECT_LT(drawing.text.size(), 12'000'000u);
  const Pairs points = Drawing::line(drawing.panels[0], 0);
  EXPECT_LT(points.size(), 20'000u);
  const Scale across = Drawing::scale(drawing.panels[0], true), up = Drawing::scale(drawing.panels[0], false);
  EXPECT_NEAR(points.front().first, across.at(0), 0.05);
  EXPECT_NEAR(points.back().first, across.at(count - 1), 0.05);
  const auto highest =
      std::min_element(points.begin(), points.end(), [](auto a, auto b) { return a.second < b.second; });
  EXPECT_NEAR(highest->first, across.at(spike), 0.05);
  EXPECT_NEAR(highest->second, up.at(50), 0.05);
}

TEST(SvgPlot, RefusesWhatCannotBeDrawn) {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN(), infinity = std::numeric_limits<double>::infinity();
  expect_refused(Plot{}, "no panel");
  expect_refused(plot_of({series("short", {0, 1}, {0})}), "series 'short'");
  for (const double bad : {nan, infinity, -infinity, 1e301}) {
    expect_refused(plot_of({series("bad", {0, 1}, {0, bad})}), "value 1 along 'error [mm]'");
    expect_refused(plot_of({series("bad", {bad, 1}, {0, 0})}), "value 0 along 'time [s]'");
  }
  Plot plot = plot_of({series("zero", {0, 1}, {1, 0})});
  plot.rows[0][0].y.logarithmic = true;
  expect_refused(plot, "logarithmic");
  plot.rows[0][0].series[0].y = {1, 2};
  plot.rows[0][0].equal = true;
  expect_refused(plot, "equal units");
  plot = plot_of({});
  plot.rows[0][0].x.low = 3;
  plot.rows[0][0].x.high = 3;
  expect_refused(plot, "do not ascend");
  plot = plot_of({});
  plot.width = nan;
  expect_refused(plot, "width");
  plot = plot_of({});
  plot.rows[0].resize(9);
  expect_refused(plot, "side by side");
}

TEST(SvgAxis, TicksAreRoundInsideAndFew) {
  for (const double middle : {0.0, 1.0, -37.25, 1e5, 3e-9}) {
    for (double extent = 1e-6; extent < 1e9; extent *= 1.37) {
      const AxisRange range{middle - 0.4 * extent, middle + 0.6 * extent};
      const AxisTicks ticks = round_ticks(range, 6, false);
      ASSERT_GE(ticks.values.size(), 2u) << middle << " " << extent;
      ASSERT_LE(ticks.values.size(), 6u);
      const double step = ticks.values[1] - ticks.values[0];
      double digit = step / std::pow(10, std::floor(std::log10(step * (1 + 1e-9))));
      if (digit > 7) digit /= 10;
      EXPECT_NEAR(digit, digit < 1.5 ? 1 : digit < 3 ? 2 : 5, 1e-3);
      std::set<std::string> labels;
      for (std::size_t i = 0; i < ticks.values.size(); ++i) {
        EXPECT_GE(ticks.values[i], range.low - 1e-6 * extent);
        EXPECT_LE(ticks.values[i], range.high + 1e-6 * extent);
        EXPECT_NEAR(std::stod(ticks.labels[i]), ticks.values[i], 1e-3 * step) << ticks.labels[i];
        labels.insert(ticks.labels[i]);
      }
      EXPECT_EQ(labels.size(), ticks.labels.size());
    }
  }
}

TEST(SvgAxis, LabelsAreShort) {
  EXPECT_EQ(round_ticks({0, 1}, 6, false).labels, (std::vector<std::string>{"0", "0.2", "0.4", "0.6", "0.8", "1.0"}));
  EXPECT_EQ(round_ticks({-1e-9, 0.9e-7}, 5, false).labels,
            (std::vector<std::string>{"0", "2e-8", "4e-8", "6e-8", "8e-8"}));
  EXPECT_EQ(round_ticks({0, 3}, 8, true).labels, (std::vector<std::string>{"0", "1", "2", "3"}));
  EXPECT_EQ(round_ticks({-0.2, 0.2}, 8, true).labels, (std::vector<std::string>{"0"}));
  EXPECT_EQ(decade_ticks({1e-5, 1}, 8).labels, (std::vector<std::string>{"1e-5", "1e-4", "0.001", "0.01", "0.1", "1"}));
}

}  // namespace
}  // namespace softkin
