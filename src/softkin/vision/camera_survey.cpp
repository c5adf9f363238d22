#include <nlohmann/json.hpp>
#include <softkin/core/error.hpp>
#include <softkin/core/text.hpp>
#include <softkin/io/json_text.hpp>
#include <softkin/io/plain_text.hpp>
#include <softkin/vision/camera_survey.hpp>

namespace softkin::vision {

void CameraSurvey::add(const RgbImage& picture, const std::string& file) {
  if (boards_.empty()) {
    width_ = picture.width;
    height_ = picture.height;
  }
  if (picture.width != width_ || picture.height != height_)
    throw InvalidInput({file}, "the picture is not of the size of the first; all must be from one camera");
  try {
    boards_.push_back({file, find_board(picture, board_, std::nullopt)});
  } catch (const InvalidInput& error) {
    throw InvalidInput({file}, error.what());
  }
}

void CameraSurvey::fit() {
  camera_ = fit_camera(boards_, width_, height_, errors_);
}

Table CameraSurvey::shown() const {
  Table table{{{.key = "picture", .left = true}, {.key = "corners"}, {.key = "reprojection error", .unit = "px"}}};
  for (std::size_t i = 0; i < boards_.size(); ++i)
    table.rows.push_back(
        {printable(boards_[i].file), static_cast<std::int64_t>(boards_[i].points.size()), decimal(errors_[i], 3)});
  return table;
}

std::string CameraSurvey::text() const {
  return "reprojection error: " + decimal(camera_.reprojection_error, 3) +
         " pixels (root of the mean square)\nfocal length: " + decimal(camera_.fx, 2) + ", " + decimal(camera_.fy, 2) +
         " +- " + decimal(camera_.focal_error, 2) + " pixels; centre: " + decimal(camera_.cx, 2) + ", " +
         decimal(camera_.cy, 2) + " pixels\ndistortion: k1 " + number(camera_.k1, 5) + ", k2 " + number(camera_.k2, 5) +
         ", p1 " + number(camera_.p1, 5) + ", p2 " + number(camera_.p2, 5) + " (k3 is kept at 0)\n";
}

std::string CameraSurvey::json(const std::string& output) const {
  return json_text(
      Json{{"output", output},
           {"reprojection_error_px", camera_.reprojection_error},
           {"picture_errors_px", errors_},
           {"fx_px", camera_.fx},
           {"fy_px", camera_.fy},
           {"cx_px", camera_.cx},
           {"cy_px", camera_.cy},
           {"focal_error_px", camera_.focal_error},
           {"distortion", {{"k1", camera_.k1}, {"k2", camera_.k2}, {"p1", camera_.p1}, {"p2", camera_.p2}}}});
}

}  // namespace softkin::vision
