#include <CLI/CLI.hpp>
#include <memory>
#include <softkin/core/error.hpp>
#include <softkin/core/text.hpp>
#include <softkin/io/file.hpp>
#include <softkin/io/mesh/text_mesh_tools.hpp>
#include <softkin/io/picture/rgb_image.hpp>
#include <softkin/vision/board_print.hpp>
#include <softkin/vision/camera_survey.hpp>
#include <softkin/vision/pictures.hpp>

#include "cli/command.hpp"
#include "cli/terminal.hpp"
#include "cli/usage.hpp"
#include "measure.hpp"

namespace {

using namespace softkin;
using namespace softkin::cli;
using namespace softkin::vision;

struct CameraOptions {
  std::vector<std::string> pictures;
  std::string board, output;
  int threads = 0;
  bool json = false, may_replace = false;
};

struct BoardOptions {
  std::string board, output;
  double dpi = 300;
  bool may_replace = false;
};

int measure_board(const BoardOptions& options) {
  const BoardSpec board = parse_board(options.board);
  const std::vector<Output> outputs{{"-o", options.output}};
  check_outputs(outputs, {}, options.may_replace);
  const bool svg = lower_extension(options.output) == ".svg";
  const std::string content = svg ? board_svg(board) : encode_png(board_picture(board, options.dpi));
  const OutputFolders folders(outputs);
  write_file(options.output, content);
  print("wrote " + options.output + ": " + decimal(board.width(), 1) + " x " + decimal(board.height(), 1) +
        " mm without its margin" + (svg ? "" : " at " + number(options.dpi) + " dots per inch") +
        "; print it at 100 % and measure the print\n");
  return done;
}

int measure_camera(const CameraOptions& options) {
  CameraSurvey survey(parse_board(options.board));
  const std::vector<Output> outputs{{"-o", options.output}};
  check_outputs(outputs, {options.pictures.begin(), options.pictures.end()}, options.may_replace);
  {
    ProgressLine progress;
    for (const std::string& file : options.pictures) {
      progress.show(static_cast<double>(survey.size()) / static_cast<double>(options.pictures.size()), file);
      survey.add(read_picture(file), file);
    }
  }
  survey.fit();
  const OutputFolders folders(outputs);
  write_file(options.output, camera_text(survey.camera()));
  print(options.json ? survey.json(options.output) + "\n"
                     : table_text(survey.shown()) + survey.text() + "wrote " + options.output + "\n");
  return done;
}

void add_common(CLI::App& command, bool& json, int& threads) {
  command.add_flag("--json", json, "Print JSON; its keys name the units");
  add_value(command, "--threads", threads, "N", "Threads of OpenCV (default: one a core)",
            CLI::Range(1, 1024).description(""));
}

void add_what(CLI::App& app, PicturesOptions& options) {
  add_value(app, "--dots", options.dots, "COLOURS",
            "Round coloured dots, one of each colour: red,tip=blue; colours: red, orange, yellow, green, cyan, blue, "
            "magenta, black, white, #rrggbb");
  app.add_flag(
         "--tags", options.tags,
         "Centres of ArUco tags: --tags for all in the first picture but those of the board, --tags=3,tip=7 for these")
      ->type_name("NUMBERS");
  add_value(app, "--dictionary", options.dictionary, "NAME",
            "Of --tags: 4x4_50 to 7x7_1000, original (default: that of the board, else 4x4_50)");
  add_value(app, "--interface", options.interface, "A,B",
            "A bar of two colours, that at the fixed end first: lengths L and L_1, and from the second picture on "
            "Delta L and Delta L_1 against the first, for softkin calibrate material");
  add_value(app, "--outline", options.outline, "LOOK",
            "The outer outline of the largest part of a colour, or of what is dark or bright against the ground, for "
            "softkin calibrate robot");
  add_value(app, "--angle", options.angles, "A,B[,C,D]",
            "Angle of the line from marker A to B against x, or against that from C to D [degrees]");
}

void add_frame(CLI::App& app, PicturesOptions& options) {
  add_value(app, "--scale-board", options.board, "BOARD",
            "A printed board: 5x4,tag=12mm,gap=3mm or charuco,7x5,square=10mm,tag=7mm; also dictionary=5x5_100, "
            "first=10 (its first tag)");
  add_value(app, "--scale", options.scale, "POINTS",
            "Two points at a known distance in the first picture: markers a,b=25mm or pixels x1,y1,x2,y2=25mm; the "
            "camera must look straight at the plane");
  add_value(app, "--camera", options.camera, "F.yaml", "Lens distortion to take out, by softkin measure camera");
  add_value(app, "--origin", options.origin, "NAME",
            "Marker that is the origin of mm, where it is in the first picture");
  add_value(app, "--x-axis", options.x_axis, "A,B", "Markers from which to which x goes, in the first picture");
  add_value(app, "--fps", options.fps, "N", "Frames per second: the pictures are a film",
            CLI::PositiveNumber.description(""));
  app.add_flag("--moving-camera", options.moving_camera,
               "Find the board in each frame of a film, not in the first alone");
}

bool film_of(const PicturesOptions& options) {
  const bool film = options.fps > 0 || is_film(options.pictures.at(0));
  if (film && !options.interface.empty())
    throw CLI::ValidationError("--interface", "is measured in pictures, not in a film");
  if (film && !options.outline.empty())
    throw CLI::ValidationError("--outline", "is measured in pictures, not in a film");
  if (film && options.output.empty()) throw CLI::ValidationError("-o", "a track of a film needs a file to go to");
  if (film && options.pictures.size() > 1 && is_film(options.pictures.at(0)))
    throw CLI::ValidationError("PICTURES", "give one film at a time");
  if (!options.output.empty() && lower_extension(options.output) != ".csv")
    throw CLI::ValidationError("-o", "must end in .csv");
  if (!film && options.moving_camera) throw CLI::ValidationError("--moving-camera", "is for a film");
  return film;
}

void add_photos(CLI::App& app, Run& run) {
  const auto options = std::make_shared<PicturesOptions>();
  add_value(app, "PICTURES", options->pictures, "",
            "Pictures (PNG, JPEG, TIFF, ...); or a film: a video, a folder of numbered pictures, pictures with --fps");
  add_what(app, *options);
  add_frame(app, *options);
  add_value(app, "-o,--output", options->output, "F.csv",
            "Table to write: one row a picture, t_s,x_mm,y_mm of a film, or picture,x_mm,y_mm of outlines");
  add_overwriting(app, options->may_replace);
  add_common(app, options->json, options->threads);
  app.footer(
      "mm: x to the right, y up; the origin is the lower left corner of the board, or the first point of --scale. "
      "Errors are standard errors. Exit code: 0 done, 1 frames of a film were left out, 2 bad usage or bad input.\n"
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
  add_value(command, "PICTURES", options->pictures, "", "4 or more, better 10 to 20, under different angles")
      ->required();
  add_value(command, "--board", options->board, "BOARD",
            "The board: checker,9x6,square=10mm (squares, not corners) or charuco,7x5,square=10mm,tag=7mm")
      ->required();
  add_value(command, "-o,--output", options->output, "F.yaml", "Camera to write")->required();
  add_overwriting(command, options->may_replace);
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
  add_value(command, "BOARD", options->board, "",
            "5x4,tag=12mm,gap=3mm, charuco,7x5,square=10mm,tag=7mm or checker,9x6,square=10mm")
      ->required();
  add_value(command, "-o,--output", options->output, "F", "File to write: .svg (true to scale) or .png")->required();
  add_value(command, "--dpi", options->dpi, "N", "Dots per inch of a .png (default: 300)",
            CLI::Range(10, 4800).description(""));
  add_overwriting(command, options->may_replace);
  command.footer("Example:\n  softkin measure board 5x4,tag=30mm,gap=8mm -o board.svg");
  command.callback([&run, options] {
    const std::string extension = lower_extension(options->output);
    if (extension != ".svg" && extension != ".png") throw CLI::ValidationError("-o", "must end in .svg or .png");
    run = [options] { return measure_board(*options); };
  });
}

}  // namespace

int softkin::cli::measure_program(int argc, const char* const* argv) {
  CLI::App app{"Measure in pictures: markers, specimens, angles, tracks, outlines; in mm", "softkin measure"};
  app.formatter(std::make_shared<PageFormatter>());
  app.set_version_flag("--version", "softkin " SOFTKIN_VERSION);
  app.require_subcommand(0, 1);
  Run run;
  add_photos(app, run);
  add_camera(app, run);
  add_board(app, run);
  return outcome_of([&] {
    std::string command = "softkin measure";
    if (const std::string wrong = misspelt(app, argc, argv, command); !wrong.empty())
      return refuse_usage(wrong, command);
    try {
      app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
      return answer_usage(app, error, "softkin measure");
    }
    return run();
  });
}
