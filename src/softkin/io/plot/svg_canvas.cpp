#include <cmath>
#include <cstdio>
#include <set>
#include <softkin/io/own_file.hpp>
#include <softkin/io/plain_text.hpp>
#include <softkin/io/plot/svg_canvas.hpp>
#include <utility>

namespace softkin {

namespace {

/// A hundredth of a pixel is finer than any screen; no "-0.00".
std::string pixels(double value) {
  char text[48];
  std::snprintf(text, sizeof text, "%.2f", value);
  std::string digits = text;
  while (digits.back() == '0') digits.pop_back();
  if (digits.back() == '.') digits.pop_back();
  return digits == "-0" ? "0" : digits;
}

std::string attribute(const char* name, double value) {
  return std::string(" ") + name + "=\"" + pixels(value) + "\"";
}

/// Corners of the marks' shapes for radius 1; "Z" closes what a polygon is.
std::string mark_path(SvgPoint at, int shape, double r) {
  const auto polygon = [&](const std::vector<SvgPoint>& corners) {
    std::string path;
    for (const SvgPoint& c : corners)
      path += (path.empty() ? "M" : "L") + pixels(at.x + r * c.x) + "," + pixels(at.y + r * c.y);
    return path + "Z";
  };
  const auto strokes = [&](double x, double y) {
    return "M" + pixels(at.x - r * x) + "," + pixels(at.y - r * y) + "L" + pixels(at.x + r * x) + "," +
           pixels(at.y + r * y);
  };
  switch (shape) {
    case 0: {
      const std::string arc = "a" + pixels(r) + "," + pixels(r) + " 0 1,0 ";
      return "M" + pixels(at.x - r) + "," + pixels(at.y) + arc + pixels(2 * r) + ",0" + arc + pixels(-2 * r) + ",0Z";
    }
    case 1:
      return polygon({{-0.9, -0.9}, {0.9, -0.9}, {0.9, 0.9}, {-0.9, 0.9}});
    case 2:
      return polygon({{0, -1.2}, {1.1, 0.8}, {-1.1, 0.8}});
    case 3:
      return polygon({{0, -1.3}, {1.3, 0}, {0, 1.3}, {-1.3, 0}});
    case 4:
      return strokes(1, 1) + strokes(1, -1);
    case 5:
      return strokes(1.3, 0) + strokes(0, 1.3);
    default:
      return polygon({{0, 1.2}, {1.1, -0.8}, {-1.1, -0.8}});
  }
}

bool begins_character(char c) {
  return (static_cast<unsigned char>(c) & 0xC0) != 0x80;
}

}  // namespace

SvgCanvas::SvgCanvas(double width, double height, const std::string& title) {
  const std::string size = pixels(width) + " " + pixels(height);
  text_ = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n" + std::string(xml_mark) +
          "<svg xmlns=\"http://www.w3.org/2000/svg\"" + attribute("width", width) + attribute("height", height) +
          " viewBox=\"0 0 " + size +
          "\" font-family=\"Helvetica, Arial, 'Liberation Sans', 'DejaVu Sans', sans-serif\">\n";
  if (!title.empty()) text_ += "<title>" + svg_escaped(title) + "</title>\n";
  text_ += "<rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n";
}

void SvgCanvas::open(const std::string& name, const std::string& attributes) {
  text_ += "<g class=\"" + name + "\"" + (attributes.empty() ? "" : " " + attributes) + ">\n";
}

void SvgCanvas::close() {
  text_ += "</g>\n";
}

void SvgCanvas::text(const SvgText& text) {
  text_ += "<text" + attribute("x", text.at.x) + attribute("y", text.at.y) + attribute("font-size", text.size);
  if (text.anchor != SvgAnchor::start)
    text_ += std::string(" text-anchor=\"") + (text.anchor == SvgAnchor::middle ? "middle" : "end") + "\"";
  if (text.bold) text_ += " font-weight=\"bold\"";
  if (text.upwards) text_ += " transform=\"rotate(-90 " + pixels(text.at.x) + " " + pixels(text.at.y) + ")\"";
  text_ += ">" + svg_escaped(text.text) + "</text>\n";
}

void SvgCanvas::add_stroke(const SvgStroke& stroke) {
  text_ += " fill=\"" + stroke.fill + "\" stroke=\"" + stroke.color + "\"" + attribute("stroke-width", stroke.width);
  if (!stroke.dashes.empty()) text_ += " stroke-dasharray=\"" + stroke.dashes + "\"";
}

void SvgCanvas::line(SvgPoint from, SvgPoint to, const SvgStroke& stroke) {
  text_ += "<line" + attribute("x1", from.x) + attribute("y1", from.y) + attribute("x2", to.x) + attribute("y2", to.y);
  add_stroke(stroke);
  text_ += "/>\n";
}

void SvgCanvas::rectangle(SvgPoint low, SvgPoint high, const SvgStroke& stroke, const std::string& name) {
  text_ += "<rect class=\"" + name + "\"" + attribute("x", low.x) + attribute("y", low.y) +
           attribute("width", high.x - low.x) + attribute("height", high.y - low.y);
  add_stroke(stroke);
  text_ += "/>\n";
}

void SvgCanvas::polyline(const std::vector<SvgPoint>& points, const SvgStroke& stroke) {
  text_ += "<polyline points=\"";
  for (std::size_t i = 0; i < points.size(); ++i)
    text_ += (i == 0 ? "" : i % 10 == 0 ? "\n" : " ") + pixels(points[i].x) + "," + pixels(points[i].y);
  text_ += "\" stroke-linejoin=\"round\"";
  add_stroke(stroke);
  text_ += "/>\n";
}

void SvgCanvas::segments(const std::vector<SvgPoint>& points, const SvgStroke& stroke) {
  text_ += "<path class=\"segments\" d=\"";
  for (std::size_t i = 0; i + 1 < points.size(); i += 2)
    text_ += (i == 0 ? "M" : "\nM") + pixels(points[i].x) + "," + pixels(points[i].y) + "L" + pixels(points[i + 1].x) +
             "," + pixels(points[i + 1].y);
  text_ += "\"";
  add_stroke(stroke);
  text_ += "/>\n";
}

void SvgCanvas::marks(const std::vector<SvgPoint>& points, int shape, double radius, const SvgStroke& stroke) {
  text_ += "<path class=\"marks\" d=\"";
  for (std::size_t i = 0; i < points.size(); ++i) text_ += (i == 0 ? "" : "\n") + mark_path(points[i], shape, radius);
  text_ += "\"";
  add_stroke(stroke);
  text_ += "/>\n";
}

void SvgCanvas::clip(const std::string& name, SvgPoint low, SvgPoint high) {
  text_ += "<clipPath id=\"" + name + "\"><rect" + attribute("x", low.x) + attribute("y", low.y) +
           attribute("width", high.x - low.x) + attribute("height", high.y - low.y) + "/></clipPath>\n";
}

std::string svg_escaped(const std::string& text) {
  std::string safe = text;
  for (std::size_t bad = find_unprintable(safe); bad != std::string::npos; bad = find_unprintable(safe))
    safe[bad] = '?';
  for (char& c : safe)
    if (c == '\n' || c == '\t' || c == '\r') c = ' ';
  return xml_escaped(safe);
}

double svg_text_width(const std::string& text, double size) {
  double ems = 0;
  for (const char c : text) {
    if (!begins_character(c)) continue;
    const bool narrow = c == ' ' || c == '.' || c == ',' || c == ':' || c == 'i' || c == 'l' || c == '\'' || c == '|';
    const bool wide =
        (c >= 'A' && c <= 'Z') || c == 'm' || c == 'w' || c == '%' || (static_cast<unsigned char>(c) > 0x7F);
    ems += narrow ? 0.34 : wide ? 0.85 : 0.62;
  }
  return ems * size;
}

std::string svg_fitted(const std::string& text, double size, double width) {
  if (svg_text_width(text, size) <= width) return text;
  std::string beginning = text;
  while (!beginning.empty() && svg_text_width(beginning + "...", size) > width) {
    while (!beginning.empty() && !begins_character(beginning.back())) beginning.pop_back();
    if (!beginning.empty()) beginning.pop_back();
  }
  return beginning + "...";
}

std::vector<SvgPoint> apart_along(const std::vector<SvgPoint>& points, double distance) {
  std::vector<SvgPoint> kept;
  for (const SvgPoint& point : points)
    if (kept.empty() || std::hypot(point.x - kept.back().x, point.y - kept.back().y) >= distance) kept.push_back(point);
  return kept;
}

std::vector<SvgPoint> thinned_line(const std::vector<SvgPoint>& points) {
  constexpr double unseen = 0.25;  // [pixel]
  std::vector<SvgPoint> kept = apart_along(points, unseen);
  if (points.empty()) return kept;
  if (kept.size() == 1 || kept.back().x != points.back().x || kept.back().y != points.back().y)
    kept.push_back(points.back());
  return kept;
}

std::vector<SvgPoint> apart_on_grid(const std::vector<SvgPoint>& points) {
  constexpr double cell = 0.5;  // [pixel]
  std::set<std::pair<double, double>> taken;
  std::vector<SvgPoint> kept;
  for (const SvgPoint& point : points)
    if (taken.emplace(std::floor(point.x / cell), std::floor(point.y / cell)).second) kept.push_back(point);
  return kept;
}

}  // namespace softkin
