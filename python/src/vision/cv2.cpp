#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <softkin/vision/open_cv.hpp>
#include <tuple>
#include <utility>

#include "../convert.hpp"

// OpenCV by Python's package: each function is that of this name in python/softkin/_opencv.py.
namespace softkin::vision::opencv {

namespace {

namespace nb = nanobind;
using python::Array;
using Picture = Array<const std::uint8_t, nb::shape<-1, -1, 3>>;
using Numbers = nb::ndarray<const double, nb::ndim<2>, nb::c_contig, nb::device::cpu>;

nb::object function(const char* name) {
  return nb::module_::import_("softkin._opencv").attr(name);
}

RgbImage image_of(const nb::object& array) {
  const auto picture = nb::cast<Picture>(array);
  RgbImage image(static_cast<int>(picture.shape(1)), static_cast<int>(picture.shape(0)));
  std::copy_n(picture.data(), image.bytes.size(), image.bytes.data());
  return image;
}

std::optional<RgbImage> optional_image(const nb::object& array) {
  if (array.is_none()) return std::nullopt;
  return image_of(array);
}

/// For the time of a call.
nb::object view_of(const GrayImage& picture) {
  const std::size_t rows = picture.height, columns = picture.width;
  return nb::cast(Array<const std::uint8_t, nb::ndim<2>>(picture.bytes.data(), {rows, columns}, nb::handle()),
                  nb::rv_policy::copy);
}

template <class Points, class Get>
nb::object array_of(const Points& points, const Get& get) {
  std::vector<double> numbers;
  for (const auto& point : points) {
    const Vec2& place = get(point);
    numbers.insert(numbers.end(), {place.x(), place.y()});
  }
  return nb::cast(Array<const double, nb::ndim<2>>(numbers.data(), {points.size(), 2}, nb::handle()),
                  nb::rv_policy::copy);
}

std::vector<Vec2> points_of(const nb::object& array) {
  const auto numbers = nb::cast<Numbers>(array);
  std::vector<Vec2> points;
  for (std::size_t i = 0; i < numbers.shape(0); ++i) points.emplace_back(numbers(i, 0), numbers(i, 1));
  return points;
}

/// Calls come from threads that have let go of Python's lock.
class PythonVideo : public Video {
 public:
  explicit PythonVideo(nb::object video) : video_(std::move(video)) {
    rate_ = nb::cast<double>(video_.attr("rate"));
    frames_ = nb::cast<double>(video_.attr("frames"));
  }

  ~PythonVideo() override {
    const nb::gil_scoped_acquire lock;
    video_.reset();
  }

  std::optional<RgbImage> next() override {
    const nb::gil_scoped_acquire lock;
    return optional_image(video_.attr("next")());
  }

 private:
  nb::object video_;
};

}  // namespace

void prepare(int threads) {
  const nb::gil_scoped_acquire lock;
  function("prepare")(threads);
}

std::optional<RgbImage> decoded(const std::string& content) {
  const nb::gil_scoped_acquire lock;
  return optional_image(function("decoded")(nb::bytes(content.data(), content.size())));
}

std::unique_ptr<Video> open_video(const std::string& file) {
  const nb::gil_scoped_acquire lock;
  nb::object video = function("open_video")(file);
  return video.is_none() ? nullptr : std::make_unique<PythonVideo>(std::move(video));
}

Dictionary dictionary(int number) {
  const nb::gil_scoped_acquire lock;
  const auto [size, modules] = nb::cast<std::tuple<int, int>>(function("dictionary")(number));
  return {.size = size, .modules = modules};
}

std::vector<std::uint8_t> tag_squares(int dictionary, int tag) {
  const nb::gil_scoped_acquire lock;
  const auto squares = nb::cast<nb::bytes>(function("tag_squares")(dictionary, tag));
  const auto* begin = static_cast<const std::uint8_t*>(squares.data());
  return {begin, begin + squares.size()};
}

std::vector<RoughTag> find_tags(const GrayImage& picture, int dictionary) {
  const nb::gil_scoped_acquire lock;
  const auto [numbers, corners] =
      nb::cast<std::tuple<std::vector<int>, Numbers>>(function("find_tags")(view_of(picture), dictionary));
  std::vector<RoughTag> tags(numbers.size());
  for (std::size_t i = 0; i < tags.size(); ++i) {
    tags[i].number = numbers[i];
    for (std::size_t k = 0; k < 4; ++k) tags[i].corners[k] = Vec2(corners(i, 2 * k), corners(i, 2 * k + 1));
  }
  return tags;
}

std::optional<std::vector<Vec2>> chessboard(const GrayImage& picture, int columns, int rows) {
  const nb::gil_scoped_acquire lock;
  const nb::object corners = function("chessboard")(view_of(picture), columns, rows);
  if (corners.is_none()) return std::nullopt;
  return points_of(corners);
}

std::vector<Vec2> crossings(const GrayImage& picture, const std::vector<Vec2>& rough, int reach) {
  const nb::gil_scoped_acquire lock;
  return points_of(function("crossings")(view_of(picture), array_of(rough, [](const Vec2& p) { return p; }), reach));
}

std::optional<Fit> calibrated(const std::vector<BoardSight>& sights, int width, int height) {
  const nb::gil_scoped_acquire lock;
  nb::list places, pixels;
  for (const BoardSight& sight : sights) {
    places.append(array_of(sight.points, [](const PlanePoint& point) { return point.place; }));
    pixels.append(array_of(sight.points, [](const PlanePoint& point) { return point.pixel; }));
  }
  const nb::object found = function("calibrated")(places, pixels, width, height);
  if (found.is_none()) return std::nullopt;
  auto [numbers, errors, rotations] = nb::cast<std::tuple<std::vector<double>, std::vector<double>, Numbers>>(found);
  Fit fit;
  std::copy_n(numbers.begin(), 4, fit.matrix.begin());
  std::copy_n(numbers.begin() + 4, 4, fit.lens.begin());
  std::copy_n(numbers.begin() + 8, 2, fit.focal_errors.begin());
  fit.reprojection_error = numbers.at(10);
  fit.errors = std::move(errors);
  for (std::size_t i = 0; i < rotations.shape(0); ++i)
    fit.rotations.push_back({rotations(i, 0), rotations(i, 1), rotations(i, 2)});
  return fit;
}

}  // namespace softkin::vision::opencv
