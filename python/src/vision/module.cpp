#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <softkin/core/error.hpp>
#include <softkin/io/file.hpp>
#include <softkin/vision/board_print.hpp>
#include <softkin/vision/camera_survey.hpp>
#include <softkin/vision/measurements.hpp>

#include "../convert.hpp"
#include "measure/measure.hpp"

namespace softkin::python {

namespace {

using namespace vision;
using Text = std::string;
using Texts = std::vector<std::string>;
using PictureIn = nb::ndarray<const std::uint8_t, nb::shape<-1, -1, 3>, nb::c_contig, nb::device::cpu>;
using PictureOut = Array<std::uint8_t, nb::shape<-1, -1, 3>>;

constexpr std::size_t min_pixels = 16;  // as read_picture() has it

RgbImage image_of(const PictureIn& array, const Text& name) {
  const std::size_t rows = array.shape(0), columns = array.shape(1);
  if (rows < min_pixels || columns < min_pixels || rows > 100'000 || columns > 100'000)
    throw InvalidInput({name}, "the picture has " + std::to_string(columns) + " x " + std::to_string(rows) +
                                   " pixels; 16 to 100000 each way can be measured");
  RgbImage image(static_cast<int>(columns), static_cast<int>(rows));
  std::copy_n(array.data(), image.bytes.size(), image.bytes.data());
  return image;
}

PictureOut array_of(RgbImage image) {
  const std::size_t rows = image.height, columns = image.width;
  auto* bytes = new std::vector<std::uint8_t>(std::move(image.bytes));
  const nb::capsule owner(bytes, [](void* memory) noexcept { delete static_cast<std::vector<std::uint8_t>*>(memory); });
  return PictureOut(bytes->data(), {rows, columns, 3}, owner);
}

/// Keys, and the numbers row by row.
std::tuple<Texts, std::vector<std::vector<double>>> numbers_of(const Table& table) {
  std::tuple<Texts, std::vector<std::vector<double>>> all;
  for (const Column& column : table.columns) std::get<0>(all).push_back(column.key);
  for (const Row& row : table.rows) {
    std::vector<double>& numbers = std::get<1>(all).emplace_back();
    for (const Cell& cell : row) numbers.push_back(std::get<double>(cell));
  }
  return all;
}

void bind_options(nb::module_& module) {
  nb::class_<Camera>(module, "Camera", "A pinhole with lens distortion.")
      .def(nb::init<>())
      .def_static(
          "of_file", [](const Text& file) { return read_camera(file); }, nb::arg("file"))
      .def_rw("width", &Camera::width)
      .def_rw("height", &Camera::height)
      .def_rw("fx", &Camera::fx)
      .def_rw("fy", &Camera::fy)
      .def_rw("cx", &Camera::cx)
      .def_rw("cy", &Camera::cy)
      .def_rw("k1", &Camera::k1)
      .def_rw("k2", &Camera::k2)
      .def_rw("p1", &Camera::p1)
      .def_rw("p2", &Camera::p2)
      .def_rw("k3", &Camera::k3)
      .def_rw("focal_error", &Camera::focal_error)
      .def_rw("reprojection_error", &Camera::reprojection_error)
      .def_rw("pictures", &Camera::pictures)
      .def("text", [](const Camera& camera) { return camera_text(camera); });
  nb::class_<MeasureOptions>(module, "Options", "What is to be measured, and how the camera sees it.")
      .def(nb::init<>())
      .def_rw("board", &MeasureOptions::board)
      .def_rw("scale", &MeasureOptions::scale)
      .def_rw("camera", &MeasureOptions::camera)
      .def_rw("lens", &MeasureOptions::lens)
      .def_rw("dots", &MeasureOptions::dots)
      .def_rw("tags", &MeasureOptions::tags)
      .def_rw("dictionary", &MeasureOptions::dictionary)
      .def_rw("interface", &MeasureOptions::interface)
      .def_rw("outline", &MeasureOptions::outline)
      .def_rw("origin", &MeasureOptions::origin)
      .def_rw("x_axis", &MeasureOptions::x_axis)
      .def_rw("angles", &MeasureOptions::angles)
      .def_rw("moving_camera", &MeasureOptions::moving_camera);
}

void bind_board(nb::module_& module) {
  nb::class_<BoardSpec>(module, "Board", "A flat pattern of known size.")
      .def(
          "__init__", [](BoardSpec* self, const Text& text) { new (self) BoardSpec(parse_board(text)); },
          nb::arg("text"))
      .def("width", &BoardSpec::width)
      .def("height", &BoardSpec::height)
      .def("svg", [](const BoardSpec& board) { return board_svg(board); })
      .def(
          "picture", [](const BoardSpec& board, double dpi) { return array_of(board_picture(board, dpi)); },
          nb::arg("dpi"))
      .def(
          "png",
          [](const BoardSpec& board, double dpi) {
            const Text content = encode_png(board_picture(board, dpi));
            return nb::bytes(content.data(), content.size());
          },
          nb::arg("dpi"));
}

/// Adds pictures from a file or from memory.
template <class Series>
void bind_adding(nb::class_<Series>& series) {
  series
      .def(
          "add_file", [](Series& self, const Text& file) { self.add(read_picture(file), file); }, nb::arg("file"),
          nb::call_guard<nb::gil_scoped_release>())
      .def(
          "add_array",
          [](Series& self, const PictureIn& picture, const Text& name) {
            const RgbImage image = image_of(picture, name);
            const nb::gil_scoped_release released;
            self.add(image, name);
          },
          nb::arg("picture"), nb::arg("name"));
}

void bind_series(nb::module_& module) {
  nb::class_<PhotoSeries> series(module, "PhotoSeries", "Photographs that are measured one after another.");
  series.def(nb::init<const MeasureOptions&>(), nb::arg("options"))
      .def("table", [](const PhotoSeries& self) { return numbers_of(self.table()); })
      .def("csv", &PhotoSeries::csv)
      .def("json", &PhotoSeries::json);
  bind_adding(series);
  nb::class_<FilmTrack>(module, "FilmTrack", "The track of a film's markers.")
      .def(
          "__init__",
          [](FilmTrack* self, const MeasureOptions& options, const Texts& files, std::optional<double> rate) {
            new (self) FilmTrack(options, {files.begin(), files.end()}, rate);
          },
          nb::arg("options"), nb::arg("files"), nb::arg("rate").none())
      .def("advance", &FilmTrack::advance, nb::call_guard<nb::gil_scoped_release>())
      .def("share", &FilmTrack::fraction)
      .def("markers", &FilmTrack::markers)
      .def("table", [](const FilmTrack& self) { return numbers_of(self.table()); })
      .def("csv", &FilmTrack::csv)
      .def("json", [](const FilmTrack& self) { return self.json(""); });
  nb::class_<CameraSurvey> survey(module, "CameraSurvey", "Pictures of a board, and the camera that took them.");
  survey.def(nb::init<BoardSpec>(), nb::arg("board"))
      .def("fit", &CameraSurvey::fit, nb::call_guard<nb::gil_scoped_release>())
      .def("camera", [](const CameraSurvey& self) { return self.camera(); })
      .def("errors", &CameraSurvey::errors)
      .def("text", &CameraSurvey::text);
  bind_adding(survey);
}

}  // namespace

}  // namespace softkin::python

NB_MODULE(_vision, module) {
  using namespace softkin;
  module.doc() = "What softkin measures in pictures, on Python's OpenCV; the public interface is softkin.measure.";
  module.def(
      "program",
      [](const std::vector<std::string>& arguments) {
        std::vector<const char*> pointers;
        for (const std::string& argument : arguments) pointers.push_back(argument.c_str());
        return cli::measure_program(static_cast<int>(pointers.size()), pointers.data());
      },
      nanobind::arg("arguments"), "softkin measure; its exit code.");
  module.def("prepare", &vision::prepare_opencv, nanobind::arg("threads"));
  python::bind_options(module);
  python::bind_board(module);
  python::bind_series(module);
}
