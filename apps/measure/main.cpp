#include <CLI/CLI.hpp>
#include <memory>
#include <softkin/core/error.hpp>
#include <softkin/io/mesh/text_mesh_tools.hpp>
#include <softkin/vision/pictures.hpp>

#include "cli/command.hpp"
#include "cli/terminal.hpp"
#include "commands.hpp"

namespace {

using namespace softkin;
using namespace softkin::cli;
using namespace softkin::vision;

void add_common(CLI::App& command, bool& json, int& threads) {
  command.add_flag("--json", json, "Print JSON; its keys name the units");
  command.add_option("--threads", threads, "Threads of OpenCV (default: one a core)")
      ->type_name("N")
      ->check(CLI::Range(1, 1024).description(""));
}

void add_board_option(CLI::App& command, const std::string& name, std::string& board) {
  command
      .add_option(name, board,
                  "A printed board: 5x4,tag=12mm,gap=3mm or charuco,7x5,square=10mm,tag=7mm; also dictionary=5x5_100, "
                  "first=10 (its first tag)")
      ->type_name("BOARD");
}

void add_what(CLI::App& app, MeasureOptions& options) {
  app.add_option("--dots", options.dots,
                 "Round coloured dots, one of each colour: red,tip=blue; colours: red, orange, yellow, green, cyan, "
                 "blue, magenta, black, white, #rrggbb")
      ->type_name("COLOURS");
  app.add_flag("--tags", options.tags,
               "Centres of ArUco tags: --tags for all in the first picture but those of the board, --tags=3,tip=7 for "
               "these")
      ->type_name("NUMBERS");
  app.add_option("--dictionary", options.dictionary, "Of --tags: 4x4_50 (default) to 7x7_1000, original")
      ->type_name("NAME");
  app.add_option("--interface", options.interface,
                 "A bar of two colours, that at the fixed end first: lengths L and L_1, and from the second picture on "
                 "Delta L and Delta L_1 against the first, for softkin calibrate material")
      ->type_name("A,B");
  app.add_option("--angle", options.angles,
                 "Angle of the line from marker A to B against x, or against that from C to D [degrees]")
      ->type_name("A,B[,C,D]");
}

void add_frame(CLI::App& app, MeasureOptions& options) {
  add_board_option(app, "--scale-board", options.board);
  app.add_option("--scale", options.scale,
                 "Two points at a known distance in the first picture: markers a,b=25mm or pixels x1,y1,x2,y2=25mm; "
                 "the camera must look straight at the plane")
      ->type_name("POINTS");
  app.add_option("--camera", options.camera, "Lens distortion to take out, by softkin measure camera")
      ->type_name("F.yaml");
  app.add_option("--origin", options.origin, "Marker that is the origin of mm, where it is in the first picture")
      ->type_name("NAME");
  app.add_option("--x-axis", options.x_axis, "Markers from which to which x goes, in the first picture")
      ->type_name("A,B");
  app.add_option("--fps", options.fps, "Frames per second: the pictures are a film")
      ->type_name("N")
      ->check(CLI::PositiveNumber.description(""));
  app.add_flag("--moving-camera", options.moving_camera,
               "Find the board in each frame of a film, not in the first alone");
}

bool film_of(const MeasureOptions& options) {
  const bool film = options.fps > 0 || is_film(options.pictures.at(0));
  if (film && !options.interface.empty())
    throw CLI::ValidationError("--interface", "is measured in pictures, not in a film");
  if (film && options.output.empty()) throw CLI::ValidationError("-o", "a track of a film needs a file to go to");
  if (film && options.pictures.size() > 1 && is_film(options.pictures.at(0)))
    throw CLI::ValidationError("PICTURES", "give one film at a time");
  if (!options.output.empty() && lower_extension(options.output) != ".csv")
    throw CLI::ValidationError("-o", "must end in .csv");
  if (!film && options.moving_camera) throw CLI::ValidationError("--moving-camera", "is for a film");
  return film;
}

void add_photos(CLI::App& app, Run& run) {
  const auto options = std::make_shared<MeasureOptions>();
  app.add_option(
         "PICTURES", options->pictures,
         "Pictures (PNG, JPEG, TIFF, ...); or a film: a video, a folder of numbered pictures, pictures with --fps")
      ->type_name("");
  add_what(app, *options);
  add_frame(app, *options);
  app.add_option("-o,--output", options->output, "Table to write: one row a picture, or t_s,x_mm,y_mm of a film")
      ->type_name("F.csv");
  add_common(app, options->json, options->threads);
  app.footer(
      "mm: x to the right, y up; the origin is the lower left corner of the board, or the first point of --scale. "
      "Errors "
      "are standard errors. Exit code: 0 done, 1 frames of a film were left out, 2 bad usage or bad input.\n"
      "Examples:\n  softkin measure rest.png bent.png --scale-board 5x4,tag=12mm,gap=3mm --dots tip=red -o tip.csv\n"
      "  softkin measure film.mp4 --scale red,blue=40mm --dots red,blue -o track.csv");
  app.callback([&app, &run, options] {
    if (!app.get_subcommands().empty()) return;
    if (options->pictures.empty()) throw CLI::RequiredError("PICTURES, camera or board");
    const bool film = film_of(*options);
    run = [options, film] {
      prepare_opencv(options->threads);
      return film ? measure_film(*options) : measure_photos(*options);
    };
  });
}

void add_camera(CLI::App& app, Run& run) {
  const auto options = std::make_shared<CameraOptions>();
  CLI::App& command = *app.add_subcommand("camera", "Camera matrix and lens distortion from pictures of a board");
  command.add_option("PICTURES", options->pictures, "4 or more, better 10 to 20, under different angles")
      ->type_name("")
      ->required();
  command
      .add_option("--board", options->board,
                  "The board: checker,9x6,square=10mm (squares, not corners) or charuco,7x5,square=10mm,tag=7mm")
      ->type_name("BOARD")
      ->required();
  command.add_option("-o,--output", options->output, "Camera to write")->type_name("F.yaml")->required();
  add_common(command, options->json, options->threads);
  command.footer("Example:\n  softkin measure camera shot*.png --board checker,9x6,square=10mm -o camera.yaml");
  command.callback([&run, options] {
    if (lower_extension(options->output) != ".yaml") throw CLI::ValidationError("-o", "must end in .yaml");
    run = [options] {
      prepare_opencv(options->threads);
      return measure_camera(*options);
    };
  });
}

void add_board(CLI::App& app, Run& run) {
  const auto options = std::make_shared<BoardOptions>();
  CLI::App& command = *app.add_subcommand("board", "Write a board to print");
  command
      .add_option("BOARD", options->board,
                  "5x4,tag=12mm,gap=3mm, charuco,7x5,square=10mm,tag=7mm or checker,9x6,square=10mm")
      ->type_name("")
      ->required();
  command.add_option("-o,--output", options->output, "File to write: .svg (true to scale) or .png")
      ->type_name("F")
      ->required();
  command.add_option("--dpi", options->dpi, "Dots per inch of a .png (default: 300)")
      ->type_name("N")
      ->check(CLI::Range(10, 4800).description(""));
  command.footer("Example:\n  softkin measure board 5x4,tag=30mm,gap=8mm -o board.svg");
  command.callback([&run, options] {
    const std::string extension = lower_extension(options->output);
    if (extension != ".svg" && extension != ".png") throw CLI::ValidationError("-o", "must end in .svg or .png");
    run = [options] { return measure_board(*options); };
  });
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{"Measure in pictures: markers, specimens, angles, tracks; in mm", "softkin measure"};
  app.set_version_flag("--version", "softkin " SOFTKIN_VERSION);
  app.require_subcommand(0, 1);
  Run run;
  add_photos(app, run);
  add_camera(app, run);
  add_board(app, run);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return answer_usage(app, error, "softkin measure");
  }
  return outcome_of(run);
}
