#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <softkin/core/dense.hpp>
#include <softkin/core/error.hpp>
#include <softkin/vision/outlines.hpp>
#include <softkin/vision/pixels.hpp>
#include <softkin/vision/specimen_edges.hpp>

namespace softkin::vision {

namespace {

constexpr int min_part_area = 100;           // [px]
constexpr double rival_part_fraction = 0.3;  // of the largest part's area
constexpr int margin = 4;                    // to the frame [px]
constexpr double used_width = 0.7;           // of the specimen: its long edges are rounded by blur
constexpr double reach = 6;                  // of the window around an edge [px]
constexpr double levels = 3;                 // beyond it, where the colours on both sides are read [px]
constexpr int level_samples = 6;             // there, in each strip
constexpr double strip_step = 0.5;           // along a strip [px]
constexpr double degrees = 180 / std::numbers::pi;

/// The outline of the part of a specimen that has this colour [mm].
std::vector<Vec2> outline_in_mm(const RgbImage& picture, const Colour& colour, const PlaneView& view) {
  const std::vector<Blob> blobs = find_blobs(picture, colour, min_part_area);
  const std::string part = "part of the specimen that is " + colour.name;
  if (blobs.empty()) throw InvalidInput("no " + part + " found");
  if (blobs.size() > 1 && blobs[1].area > rival_part_fraction * blobs[0].area)
    throw InvalidInput("two candidates for the " + part);
  if (blobs[0].touches_frame(picture, margin)) throw InvalidInput("the " + part + " is partly outside the frame");
  std::vector<Vec2> outline = outline_of(blobs[0]);
  for (Vec2& place : outline) place = view.to_mm(place);
  return outline;
}

/// The frame of a specimen: along its axis from A to B and across it [mm].
struct BarFrame {
  Vec2 origin, along, across;
  double half_width = 0;  // that is used
  double pixel = 0;       // side of a pixel here

  [[nodiscard]] Vec2 place(double s, double t) const { return origin + s * along + t * across; }
};

BarFrame frame_of(const AreaMoments& a, const AreaMoments& b, const PlaneView& view) {
  const double area = a.area + b.area;
  const Vec2 from_a_to_b = b.centre - a.centre;
  BarFrame frame;
  frame.origin = (a.area * a.centre + b.area * b.centre) / area;
  const Eigen::Matrix2d spread =
      (a.area * a.second + b.area * b.second) / area - frame.origin * frame.origin.transpose();
  const SymmetricEigen axes = symmetric_eigen(spread);
  frame.along = axes.vectors.col(1);
  if (frame.along.dot(from_a_to_b) < 0) frame.along = -frame.along;
  frame.across = Vec2(-frame.along.y(), frame.along.x());
  if (!(frame.along.dot(from_a_to_b) > 0.5 * from_a_to_b.norm()))
    throw InvalidInput("the parts of the specimen lie beside each other, not one after the other along its axis");
  frame.half_width = used_width * std::sqrt(3 * axes.values[0]);
  frame.pixel = std::sqrt(view.pixel_area(view.to_pixel(frame.origin)));
  return frame;
}

/// First and last position of a part along the axis in the middle strips [mm].
std::pair<double, double> extent(const std::vector<Vec2>& outline, const BarFrame& frame) {
  std::vector<double> positions;
  for (const Vec2& place : outline) {
    const Vec2 arm = place - frame.origin;
    if (std::abs(arm.dot(frame.across)) < 0.3 * frame.half_width + frame.pixel)
      positions.push_back(arm.dot(frame.along));
  }
  if (positions.empty()) throw InvalidInput("the parts of the specimen do not lie on one axis");
  const auto [first, last] = std::minmax_element(positions.begin(), positions.end());
  return {*first, *last};
}

/// A line s = offset + slope t with its standard errors.
struct LineFit {
  double offset, slope, offset_error, slope_error;
};

/// Fits a line to rows of t, s, twice, the second time without outliers.
LineFit line_through(Eigen::MatrixX2d points) {
  LineFit fit{};
  for (int round = 0; round < 2; ++round) {
    Eigen::MatrixX2d rows(points.rows(), 2);
    rows << Eigen::VectorXd::Ones(points.rows()), points.col(0);
    const Eigen::Matrix2d inverse = (rows.transpose() * rows).inverse();
    const Vec2 line = inverse * rows.transpose() * points.col(1);
    const Eigen::VectorXd miss = points.col(1) - rows * line;
    const double variance = miss.squaredNorm() / std::max(1.0, static_cast<double>(points.rows()) - 2);
    fit = {line[0], line[1], std::sqrt(variance * inverse(0, 0)), std::sqrt(variance * inverse(1, 1))};
    std::vector<Eigen::Index> kept;
    for (Eigen::Index i = 0; i < miss.size(); ++i)
      if (std::abs(miss[i]) <= 3 * std::sqrt(variance)) kept.push_back(i);
    if (kept.size() < 5) break;
    points = points(kept, Eigen::all).eval();
  }
  return fit;
}

/// Mean colour of all strips in the level that begins at a sample.
Eigen::Vector3d mean_of(const std::vector<Eigen::Matrix3Xd>& strips, int begin) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const Eigen::Matrix3Xd& strip : strips) sum += strip.middleCols(begin, level_samples).rowwise().mean();
  return sum / static_cast<double>(strips.size());
}

/// The edge near a position. room: lengths free of other edges on both sides [mm].
SpecimenEdge edge_near(const RgbImage& rgb, const PlaneView& view, const BarFrame& frame, double position, double room,
                       const std::string& name) {
  LineFit fit{position, 0, 0, 0};
  const double half = std::min(reach * frame.pixel, 0.6 * room), level = levels * frame.pixel;
  // strips overlap in the pixels that they read; one a pixel keeps their errors nearly independent
  const int strips = static_cast<int>(2 * frame.half_width / frame.pixel);
  if (strips < 5 || half < 2 * frame.pixel)
    throw InvalidInput("the specimen is too small in the picture: its " + name + " cannot be measured");
  std::vector<double> at;  // along a strip from its middle: the level before, the edge, the level behind
  const int samples = static_cast<int>(std::ceil(2 * half / (strip_step * frame.pixel)));
  for (int k = level_samples - 1; k >= 0; --k) at.push_back(-half - level * k / level_samples);
  for (int k = 0; k < samples; ++k) at.push_back(half * (2 * (k + 0.5) / samples - 1));
  for (int k = 0; k < level_samples; ++k) at.push_back(half + level * k / level_samples);
  const auto columns = static_cast<int>(at.size());
  std::vector<Eigen::Matrix3Xd> read(strips, Eigen::Matrix3Xd(3, columns));  // colours
  for (int round = 0; round < 3; ++round) {
    Eigen::MatrixX2d points(strips, 2);
    for (int i = 0; i < strips; ++i) {
      const double t = frame.half_width * (2 * (i + 0.5) / strips - 1);
      points.row(i) << t, fit.offset + fit.slope * t;
      for (int k = 0; k < columns; ++k)
        read[std::size_t(i)].col(k) = between(rgb, view.to_pixel(frame.place(points(i, 1) + at[std::size_t(k)], t)));
    }
    const Eigen::Vector3d before = mean_of(read, 0);
    const Eigen::Vector3d contrast = mean_of(read, level_samples + samples) - before;
    const double size = contrast.squaredNorm();
    if (!(size > 40 * 40))
      throw InvalidInput("the " + name + " cannot be seen: the colours on both sides of it are nearly the same");
    for (int i = 0; i < strips; ++i) {
      // the edge is where the fraction of the colour behind it places it
      const double fraction =
          (read[std::size_t(i)].middleCols(level_samples, samples).rowwise().mean() - before).dot(contrast) / size;
      points(i, 1) += half * (1 - 2 * fraction);
    }
    fit = line_through(points);
    if (!(std::abs(fit.offset - position) < half + level) || !(std::abs(fit.slope) < 1.5))
      throw InvalidInput("the " + name + " is no straight edge across the specimen");
  }
  SpecimenEdge edge;
  edge.position = fit.offset;
  edge.place = frame.place(fit.offset, 0);
  edge.error = std::hypot(fit.offset_error, pixel_error * frame.pixel, view.error_at(view.to_pixel(edge.place)));
  edge.slant = -std::atan(fit.slope) * degrees;
  edge.slant_error = fit.slope_error / (1 + fit.slope * fit.slope) * degrees;
  return edge;
}

}  // namespace

SpecimenView find_specimen(const RgbImage& picture, const Colour& a, const Colour& b, const PlaneView& view) {
  const std::vector<Vec2> part_a = outline_in_mm(picture, a, view), part_b = outline_in_mm(picture, b, view);
  const BarFrame frame = frame_of(moments_of(part_a), moments_of(part_b), view);
  const auto [first, last_a] = extent(part_a, frame);
  const auto [first_b, last] = extent(part_b, frame);
  if (std::abs(first_b - last_a) > 12 * frame.pixel)
    throw InvalidInput("the parts of the specimen that are " + a.name + " and " + b.name + " do not meet");
  const double middle = (last_a + first_b) / 2, room = std::min(middle - first, last - middle);
  return {.fixed = edge_near(picture, view, frame, first, room, "fixed end"),
          .interface = edge_near(picture, view, frame, middle, room, "interface"),
          .free = edge_near(picture, view, frame, last, room, "free end"),
          .axis = std::atan2(frame.along.y(), frame.along.x()) * degrees};
}

double Stretch::elasticity_ratio() const {
  return rest.interface_length() * (elongation() - shift()) / ((rest.length() - rest.interface_length()) * shift());
}

double Stretch::elasticity_ratio_error() const {
  const double h = 1e-6 * rest.length();
  double variance = 0;
  for (SpecimenView Stretch::*const view : {&Stretch::rest, &Stretch::stretched})
    for (SpecimenEdge SpecimenView::*const edge :
         {&SpecimenView::fixed, &SpecimenView::interface, &SpecimenView::free}) {
      Stretch up = *this, down = *this;
      (up.*view.*edge).position += h;
      (down.*view.*edge).position -= h;
      const double slope = (up.elasticity_ratio() - down.elasticity_ratio()) / (2 * h);
      variance += std::pow(slope * (this->*view.*edge).error, 2);
    }
  return std::sqrt(variance);
}

}  // namespace softkin::vision
