#include <cmath>
#include <softkin/core/error.hpp>
#include <softkin/io/file.hpp>
#include <softkin/vision/camera.hpp>
#include <softkin/vision/pictures.hpp>
#include <softkin/vision/tags.hpp>

#include "cli/command.hpp"
#include "cli/terminal.hpp"
#include "commands.hpp"
#include "report_text.hpp"

namespace softkin::cli {

namespace {

struct Sights {
  std::vector<BoardSight> boards;
  int width = 0, height = 0;
};

Sights look(const CameraOptions& options, const BoardSpec& board) {
  Sights sights;
  ProgressLine progress;
  for (const std::string& file : options.pictures) {
    progress.show(static_cast<double>(sights.boards.size()) / static_cast<double>(options.pictures.size()), file);
    const RgbImage picture = read_picture(file);
    if (sights.boards.empty()) {
      sights.width = picture.width;
      sights.height = picture.height;
    }
    if (picture.width != sights.width || picture.height != sights.height)
      throw InvalidInput({file}, "the picture is not of the size of the first; all must be from one camera");
    try {
      sights.boards.push_back({file, find_board(picture, board, std::nullopt)});
    } catch (const InvalidInput& error) {
      throw InvalidInput({file}, error.what());
    }
  }
  return sights;
}

std::string text_of(const Camera& camera, const std::vector<BoardSight>& boards, const std::vector<double>& errors) {
  std::vector<std::vector<std::string>> rows{{"picture", "corners", "reprojection error [px]"}};
  for (std::size_t i = 0; i < boards.size(); ++i)
    rows.push_back({printable(boards[i].file), std::to_string(boards[i].points.size()), decimal(errors[i], 3)});
  return joined(aligned(rows, "lrr"), "") + "reprojection error: " + decimal(camera.reprojection_error, 3) +
         " pixels (root of the mean square)\nfocal length: " + decimal(camera.fx, 2) + ", " + decimal(camera.fy, 2) +
         " +- " + decimal(camera.focal_error, 2) + " pixels; centre: " + decimal(camera.cx, 2) + ", " +
         decimal(camera.cy, 2) + " pixels\ndistortion: k1 " + number(camera.k1, 5) + ", k2 " + number(camera.k2, 5) +
         ", p1 " + number(camera.p1, 5) + ", p2 " + number(camera.p2, 5) + " (k3 is kept at 0)\n";
}

}  // namespace

int measure_camera(const CameraOptions& options) {
  const BoardSpec board = parse_board(options.board);
  const std::vector<Output> outputs{{"-o", options.output}};
  check_outputs(outputs, {options.pictures.begin(), options.pictures.end()});
  const Sights sights = look(options, board);
  std::vector<double> errors;
  const Camera camera = fit_camera(sights.boards, sights.width, sights.height, errors);
  const OutputFolders folders(outputs);
  write_file(options.output, camera_text(camera));
  if (options.json)
    print(Json{{"output", options.output},
               {"reprojection_error_px", camera.reprojection_error},
               {"picture_errors_px", errors},
               {"fx_px", camera.fx},
               {"fy_px", camera.fy},
               {"cx_px", camera.cx},
               {"cy_px", camera.cy},
               {"focal_error_px", camera.focal_error},
               {"distortion", {{"k1", camera.k1}, {"k2", camera.k2}, {"p1", camera.p1}, {"p2", camera.p2}}}});
  else
    print(text_of(camera, sights.boards, errors) + "wrote " + options.output + "\n");
  return done;
}

}  // namespace softkin::cli
