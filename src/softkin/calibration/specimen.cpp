#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <softkin/calibration/blobs.hpp>
#include <softkin/calibration/specimen.hpp>
#include <softkin/core/error.hpp>
#include <utility>

namespace softkin {

namespace {

constexpr std::size_t least_area = 100;  // [px]
constexpr double rival_share = 0.3;      // of the largest part's area
constexpr int margin = 4;                // to the frame [px]
constexpr double used_width = 0.7;       // of the specimen: its long edges are rounded by blur
constexpr double reach = 6;              // of the window around an edge [px]
constexpr double levels = 3;             // beyond it, where the colours on both sides are read [px]
constexpr double step = 0.5;             // along a strip [px]

using Rgb3 = Eigen::Vector3d;

Rgb3 colour_at(const RgbImage& picture, const Vec2& pixel) {
  const double x = std::clamp(pixel.x(), 0.0, picture.width - 1.001),
               y = std::clamp(pixel.y(), 0.0, picture.height - 1.001);
  const int i = static_cast<int>(x), j = static_cast<int>(y);
  const double u = x - i, v = y - j;
  Rgb3 result;
  for (int c = 0; c < 3; ++c) {
    const auto value = [&](int column, int row) {
      return double(picture.bytes[3 * (std::size_t(row) * picture.width + column) + std::size_t(c)]);
    };
    result[c] = (1 - v) * ((1 - u) * value(i, j) + u * value(i + 1, j)) +
                v * ((1 - u) * value(i, j + 1) + u * value(i + 1, j + 1));
  }
  return result;
}

/// The part of a specimen that has this colour.
Blob part_of(const RgbImage& picture, const Colour& colour) {
  std::vector<Blob> blobs = find_blobs(pixels_of(colour, picture), picture.width, least_area);
  const std::string part = "part of the specimen that is " + colour.name();
  if (blobs.empty()) throw InvalidInput("no " + part + " found");
  if (blobs.size() > 1 && blobs[1].area() > rival_share * blobs[0].area())
    throw InvalidInput("two candidates for the " + part);
  if (blobs[0].touches_frame(picture.width, picture.height, margin))
    throw InvalidInput("the " + part + " is partly outside the frame");
  return std::move(blobs[0]);
}

/// A part in mm: its area's centre and spread.
struct PlanePart {
  double area = 0;  // [mm^2]
  Vec2 centre = Vec2::Zero();
  Eigen::Matrix2d second = Eigen::Matrix2d::Zero();  // moment about the origin by the area [mm^2]
};

PlanePart in_plane(const Blob& blob, const PlaneView& view, int width) {
  PlanePart part;
  for (const int pixel : blob.pixels) {
    const Vec2 seen(pixel % width, pixel / width), place = view.to_mm(seen);
    const double area = view.pixel_area(seen);
    part.area += area;
    part.centre += area * place;
    part.second += area * place * place.transpose();
  }
  part.centre /= part.area;
  part.second /= part.area;
  return part;
}

/// The frame of a specimen: along its axis from A to B and across it [mm].
struct Frame {
  Vec2 origin, along, across;
  double half_width = 0;  // that is used
  double pixel = 0;       // side of a pixel here

  [[nodiscard]] Vec2 place(double s, double t) const { return origin + s * along + t * across; }
};

Frame frame_of(const PlanePart& a, const PlanePart& b, const PlaneView& view) {
  const double area = a.area + b.area;
  Frame frame;
  frame.origin = (a.area * a.centre + b.area * b.centre) / area;
  const Eigen::Matrix2d spread =
      (a.area * a.second + b.area * b.second) / area - frame.origin * frame.origin.transpose();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> solver(spread);
  frame.along = solver.eigenvectors().col(1);
  if (frame.along.dot(b.centre - a.centre) < 0) frame.along = -frame.along;
  frame.across = Vec2(-frame.along.y(), frame.along.x());
  if (!(frame.along.dot(b.centre - a.centre) > 0.5 * (b.centre - a.centre).norm()))
    throw InvalidInput("the parts of the specimen lie beside each other, not one after the other along its axis");
  frame.half_width = used_width * std::sqrt(3 * solver.eigenvalues()[0]);
  frame.pixel = std::sqrt(view.pixel_area(view.to_pixel(frame.origin)));
  return frame;
}

/// First and last position of a part along the axis in the middle strips [mm].
std::pair<double, double> extent(const Blob& blob, const Frame& frame, const PlaneView& view, int width) {
  std::vector<double> positions;
  for (const int pixel : blob.pixels) {
    const Vec2 arm = view.to_mm(Vec2(pixel % width, pixel / width)) - frame.origin;
    if (std::abs(arm.dot(frame.across)) < 0.3 * frame.half_width + frame.pixel)
      positions.push_back(arm.dot(frame.along));
  }
  if (positions.empty()) throw InvalidInput("the parts of the specimen do not lie on one axis");
  std::sort(positions.begin(), positions.end());
  const std::size_t n = positions.size();
  return {positions[n / 200], positions[n - 1 - n / 200]};
}

/// Position of an edge within one strip, from the share of what lies behind it.
double edge_in_strip(const std::vector<Rgb3>& strip, const Rgb3& before, const Rgb3& behind, double low, double width) {
  const Rgb3 contrast = behind - before;
  double share = 0;
  for (const Rgb3& colour : strip) share += (colour - before).dot(contrast) / contrast.squaredNorm();
  return low + width * (1 - share / static_cast<double>(strip.size()));
}

struct LineFit {
  double offset, slope, offset_error, slope_error;
};

/// Line through (t, s), twice, the second time without what lies far off.
LineFit line_through(std::vector<Vec2> points) {
  LineFit fit{};
  for (int round = 0; round < 2; ++round) {
    const double n = static_cast<double>(points.size());
    double st = 0, stt = 0, ss = 0, sst = 0;
    for (const Vec2& p : points) st += p.x(), stt += p.x() * p.x(), ss += p.y(), sst += p.x() * p.y();
    const double determinant = n * stt - st * st;
    fit.slope = (n * sst - st * ss) / determinant;
    fit.offset = (ss - fit.slope * st) / n;
    double squares = 0;
    for (const Vec2& p : points) squares += std::pow(p.y() - fit.offset - fit.slope * p.x(), 2);
    const double variance = squares / std::max(1.0, n - 2);
    fit.offset_error = std::sqrt(variance * stt / determinant);
    fit.slope_error = std::sqrt(variance * n / determinant);
    std::vector<Vec2> kept;
    for (const Vec2& p : points)
      if (std::abs(p.y() - fit.offset - fit.slope * p.x()) <= 3 * std::sqrt(variance)) kept.push_back(p);
    if (kept.size() < 5) break;
    points = std::move(kept);
  }
  return fit;
}

/// The edge near a position. room: lengths free of other edges on both sides [mm].
SpecimenEdge edge_near(const RgbImage& picture, const PlaneView& view, const Frame& frame, double position, double room,
                       const std::string& name) {
  double slope = 0;
  LineFit fit{position, 0, 0, 0};
  const double half = std::min(reach * frame.pixel, 0.6 * room), level = levels * frame.pixel;
  // strips overlap in the pixels that they read; one a pixel keeps their errors nearly independent
  const int strips = static_cast<int>(2 * frame.half_width / frame.pixel);
  if (strips < 5 || half < 2 * frame.pixel)
    throw InvalidInput("the specimen is too small in the picture: its " + name + " cannot be measured");
  const int samples = static_cast<int>(std::ceil(2 * half / (step * frame.pixel)));
  for (int round = 0; round < 3; ++round) {
    Rgb3 before = Rgb3::Zero(), behind = Rgb3::Zero();
    std::vector<std::pair<double, std::vector<Rgb3>>> read;
    for (int i = 0; i < strips; ++i) {
      const double t = frame.half_width * (2 * (i + 0.5) / strips - 1), middle = fit.offset + slope * t;
      const auto colour = [&](double s) { return colour_at(picture, view.to_pixel(frame.place(middle + s, t))); };
      std::vector<Rgb3> strip;
      for (int k = 0; k < samples; ++k) strip.push_back(colour(half * (2 * (k + 0.5) / samples - 1)));
      for (int k = 0; k < 6; ++k) {
        before += colour(-half - level * k / 6) / (6.0 * strips);
        behind += colour(half + level * k / 6) / (6.0 * strips);
      }
      read.emplace_back(t, std::move(strip));
    }
    if (!((behind - before).norm() > 40))
      throw InvalidInput("the " + name + " cannot be seen: the colours on both sides of it are nearly the same");
    std::vector<Vec2> points;
    for (const auto& [t, strip] : read)
      points.emplace_back(t, edge_in_strip(strip, before, behind, fit.offset + slope * t - half, 2 * half));
    fit = line_through(std::move(points));
    slope = fit.slope;
    if (!(std::abs(fit.offset - position) < half + level) || !(std::abs(slope) < 1.5))
      throw InvalidInput("the " + name + " is no straight edge across the specimen");
  }
  SpecimenEdge edge;
  edge.position = fit.offset;
  edge.place = frame.place(fit.offset, 0);
  edge.error = std::hypot(fit.offset_error, pixel_error * frame.pixel, view.error_at(view.to_pixel(edge.place)));
  edge.slant = -std::atan(slope) * 180 / std::numbers::pi;
  edge.slant_error = fit.slope_error / (1 + slope * slope) * 180 / std::numbers::pi;
  return edge;
}

std::array<double, 6> positions_of(const Stretch& stretch) {
  return {stretch.rest.fixed.position,      stretch.rest.interface.position,      stretch.rest.free.position,
          stretch.stretched.fixed.position, stretch.stretched.interface.position, stretch.stretched.free.position};
}

double ratio_of(const std::array<double, 6>& p) {
  const double strain_a = (p[4] - p[3]) / (p[1] - p[0]) - 1, strain_b = (p[5] - p[4]) / (p[2] - p[1]) - 1;
  return strain_b / strain_a;
}

}  // namespace

SpecimenView find_specimen(const RgbImage& picture, const Colour& a, const Colour& b, const PlaneView& view) {
  const Blob part_a = part_of(picture, a), part_b = part_of(picture, b);
  const Frame frame = frame_of(in_plane(part_a, view, picture.width), in_plane(part_b, view, picture.width), view);
  const auto [first, last_a] = extent(part_a, frame, view, picture.width);
  const auto [first_b, last] = extent(part_b, frame, view, picture.width);
  if (std::abs(first_b - last_a) > 12 * frame.pixel)
    throw InvalidInput("the parts of the specimen that are " + a.name() + " and " + b.name() + " do not meet");
  const double middle = (last_a + first_b) / 2, room = std::min(middle - first, last - middle);
  SpecimenView result;
  result.fixed = edge_near(picture, view, frame, first, room, "fixed end");
  result.interface = edge_near(picture, view, frame, middle, room, "interface");
  result.free = edge_near(picture, view, frame, last, room, "free end");
  result.axis = std::atan2(frame.along.y(), frame.along.x()) * 180 / std::numbers::pi;
  return result;
}

double SpecimenView::length_error() const {
  return std::hypot(fixed.error, free.error);
}

double SpecimenView::interface_error() const {
  return std::hypot(fixed.error, interface.error);
}

double Stretch::elongation_error() const {
  return std::hypot(rest.length_error(), stretched.length_error());
}

double Stretch::shift_error() const {
  return std::hypot(rest.interface_error(), stretched.interface_error());
}

double Stretch::elasticity_ratio() const {
  return ratio_of(positions_of(*this));
}

double Stretch::elasticity_ratio_error() const {
  const std::array<double, 6> at = positions_of(*this);
  const std::array<double, 6> errors{rest.fixed.error,      rest.interface.error,      rest.free.error,
                                     stretched.fixed.error, stretched.interface.error, stretched.free.error};
  const double h = 1e-6 * rest.length();
  double variance = 0;
  for (std::size_t i = 0; i < 6; ++i) {
    std::array<double, 6> up = at, down = at;
    up[i] += h;
    down[i] -= h;
    variance += std::pow((ratio_of(up) - ratio_of(down)) / (2 * h) * errors[i], 2);
  }
  return std::sqrt(variance);
}

}  // namespace softkin
