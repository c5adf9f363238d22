#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>
#include <softkin/core/error.hpp>
#include <softkin/io/file.hpp>
#include <softkin/io/json_text.hpp>
#include <softkin/io/mesh/text_mesh_tools.hpp>
#include <softkin/io/picture/rgb_image.hpp>
#include <softkin/io/plain_text.hpp>
#include <softkin/io/table/table.hpp>
#include <softkin/vision/pictures.hpp>

#include "cli/command.hpp"
#include "cli/terminal.hpp"
#include "cli/usage.hpp"
#include "measurer.hpp"

namespace {

using namespace softkin;
using namespace softkin::cli;
using namespace softkin::vision;

struct CameraOptions {
  std::vector<std::string> pictures;
  std::string board, output;
  int threads = 0;
  bool json = false;
};

struct BoardOptions {
  std::string board, output;
  double dpi = 300;
};

/// White around the board, without which its outer tags are not found [mm].
double margin_of(const BoardSpec& board) {
  return board.kind == BoardSpec::Kind::grid ? board.tag / 4 : board.square / 2;
}

std::string svg_of(const BoardSpec& board) {
  const double margin = margin_of(board), width = board.width() + 2 * margin, height = board.height() + 2 * margin;
  const auto mm = [](double value) { return number(value, 9); };
  std::string text = "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"" + mm(width) + "mm\" height=\"" + mm(height) +
                     "mm\" viewBox=\"0 0 " + mm(width) + " " + mm(height) +
                     "\" shape-rendering=\"crispEdges\">\n<rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n";
  for (const auto& [x, y, w, h] : board_squares(board))
    text += "<rect x=\"" + mm(margin + x) + "\" y=\"" + mm(margin + board.height() - y - h) + "\" width=\"" + mm(w) +
            "\" height=\"" + mm(h) + "\"/>\n";
  return text + "</svg>\n";
}

RgbImage picture_of(const BoardSpec& board, double pixels) {
  const double margin = margin_of(board);
  const double columns = std::ceil((board.width() + 2 * margin) * pixels);
  const double rows = std::ceil((board.height() + 2 * margin) * pixels);
  if (!(columns * rows <= 1e8 && columns >= 16 && rows >= 16))
    throw InvalidInput("--dpi: the picture would have " + number(columns) + " x " + number(rows) + " pixels");
  RgbImage picture(static_cast<int>(columns), static_cast<int>(rows));
  // edges between pixels are shades, so that the picture is true to scale at any resolution
  std::vector<double> dark(static_cast<std::size_t>(columns * rows), 0);
  for (const auto& [x, y, w, h] : board_squares(board)) {
    const double left = (margin + x) * pixels, right = left + w * pixels;
    const double top = (margin + board.height() - y - h) * pixels, bottom = top + h * pixels;
    for (int row = static_cast<int>(top); row < std::min(bottom, rows); ++row)
      for (int column = static_cast<int>(left); column < std::min(right, columns); ++column)
        dark[std::size_t(row) * std::size_t(picture.width) + std::size_t(column)] +=
            (std::min(bottom, row + 1.0) - std::max(top, double(row))) *
            (std::min(right, column + 1.0) - std::max(left, double(column)));
  }
  for (std::size_t i = 0; i < dark.size(); ++i)
    std::fill_n(picture.bytes.begin() + static_cast<std::ptrdiff_t>(3 * i), 3, to_byte(std::max(0.0, 1 - dark[i])));
  return picture;
}

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
  Table table{{{.key = "picture", .left = true}, {.key = "corners"}, {.key = "reprojection error", .unit = "px"}}};
  for (std::size_t i = 0; i < boards.size(); ++i)
    table.rows.push_back(
        {printable(boards[i].file), static_cast<std::int64_t>(boards[i].points.size()), decimal(errors[i], 3)});
  return table_text(table) + "reprojection error: " + decimal(camera.reprojection_error, 3) +
         " pixels (root of the mean square)\nfocal length: " + decimal(camera.fx, 2) + ", " + decimal(camera.fy, 2) +
         " +- " + decimal(camera.focal_error, 2) + " pixels; centre: " + decimal(camera.cx, 2) + ", " +
         decimal(camera.cy, 2) + " pixels\ndistortion: k1 " + number(camera.k1, 5) + ", k2 " + number(camera.k2, 5) +
         ", p1 " + number(camera.p1, 5) + ", p2 " + number(camera.p2, 5) + " (k3 is kept at 0)\n";
}

int measure_board(const BoardOptions& options) {
  const BoardSpec board = parse_board(options.board);
  const std::vector<Output> outputs{{"-o", options.output}};
  check_outputs(outputs, {});
  const bool svg = lower_extension(options.output) == ".svg";
  const std::string content = svg ? svg_of(board) : encode_png(picture_of(board, options.dpi / 25.4));
  const OutputFolders folders(outputs);
  write_file(options.output, content);
  print("wrote " + options.output + ": " + decimal(board.width(), 1) + " x " + decimal(board.height(), 1) +
        " mm without its margin" + (svg ? "" : " at " + number(options.dpi) + " dots per inch") +
        "; print it at 100 % and measure the print\n");
  return done;
}

int measure_camera(const CameraOptions& options) {
  const BoardSpec board = parse_board(options.board);
  const std::vector<Output> outputs{{"-o", options.output}};
  check_outputs(outputs, {options.pictures.begin(), options.pictures.end()});
  const Sights sights = look(options, board);
  std::vector<double> errors;
  const Camera camera = fit_camera(sights.boards, sights.width, sights.height, errors);
  const OutputFolders folders(outputs);
  write_file(options.output, camera_text(camera));
  if (options.json) {
    const Json json{{"output", options.output},
                    {"reprojection_error_px", camera.reprojection_error},
                    {"picture_errors_px", errors},
                    {"fx_px", camera.fx},
                    {"fy_px", camera.fy},
                    {"cx_px", camera.cx},
                    {"cy_px", camera.cy},
                    {"focal_error_px", camera.focal_error},
                    {"distortion", {{"k1", camera.k1}, {"k2", camera.k2}, {"p1", camera.p1}, {"p2", camera.p2}}}};
    print(json_text(json) + "\n");
  } else {
    print(text_of(camera, sights.boards, errors) + "wrote " + options.output + "\n");
  }
  return done;
}

void add_common(CLI::App& command, bool& json, int& threads) {
  command.add_flag("--json", json, "Print JSON; its keys name the units");
  add_value(command, "--threads", threads, "N", "Threads of OpenCV (default: one a core)",
            CLI::Range(1, 1024).description(""));
}

void add_what(CLI::App& app, MeasureOptions& options) {
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
  add_value(app, "--angle", options.angles, "A,B[,C,D]",
            "Angle of the line from marker A to B against x, or against that from C to D [degrees]");
}

void add_frame(CLI::App& app, MeasureOptions& options) {
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
  add_value(app, "PICTURES", options->pictures, "",
            "Pictures (PNG, JPEG, TIFF, ...); or a film: a video, a folder of numbered pictures, pictures with --fps");
  add_what(app, *options);
  add_frame(app, *options);
  add_value(app, "-o,--output", options->output, "F.csv",
            "Table to write: one row a picture, or t_s,x_mm,y_mm of a film");
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
