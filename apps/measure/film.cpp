#include <memory>
#include <softkin/core/error.hpp>
#include <softkin/io/file.hpp>
#include <softkin/vision/pictures.hpp>

#include "cli/command.hpp"
#include "cli/terminal.hpp"
#include "commands.hpp"
#include "measurer.hpp"
#include "report_text.hpp"
#include "tables.hpp"

namespace softkin::cli {

namespace {

constexpr std::size_t most_losses = 5;

struct Track {
  NumberTable table;
  std::vector<std::string> lost;  // why a frame is left out
  std::size_t frames = 0;
};

/// The first frame must show all; a later one that does not is left out, and said to be.
Track follow(Film& film, Measurer& measurer) {
  Track track;
  ProgressLine progress;
  while (const std::optional<Frame> frame = film.next()) {
    ++track.frames;
    const double share = film.frames() > 0 ? double(track.frames) / double(film.frames()) : -1;
    progress.show(share, "frame " + std::to_string(track.frames));
    try {
      const Measurer::Seen seen = measurer.measure(frame->picture, frame->name);
      std::vector<double> row{frame->time};
      for (const NamedMarker& marker : seen.markers) row.insert(row.end(), {marker.at.place.x(), marker.at.place.y()});
      for (const Angle& angle : seen.angles) row.push_back(angle.degrees);
      if (track.table.columns.empty()) {
        track.table.columns = {"t_s"};
        for (const NamedMarker& marker : seen.markers)
          for (const char* axis : {"x_mm", "y_mm"})
            track.table.columns.push_back((seen.markers.size() == 1 ? "" : marker.name + "_") + axis);
        for (const Angle& angle : seen.angles) track.table.columns.push_back(angle.name + "_deg");
      }
      track.table.rows.push_back(std::move(row));
    } catch (const InvalidInput& error) {
      if (track.frames == 1) throw;
      track.lost.emplace_back(error.what());
    }
  }
  if (film.frames() > track.frames + 1)
    track.lost.push_back("the film says that it has " + std::to_string(film.frames()) + " frames; it ends early");
  return track;
}

std::unique_ptr<Film> open(const MeasureOptions& options) {
  const std::optional<double> rate = options.fps > 0 ? std::optional<double>(options.fps) : std::nullopt;
  if (options.pictures.size() == 1) return std::make_unique<Film>(std::filesystem::path(options.pictures[0]), rate);
  return std::make_unique<Film>(std::vector<std::filesystem::path>(options.pictures.begin(), options.pictures.end()),
                                rate);
}

}  // namespace

int measure_film(const MeasureOptions& options) {
  const std::vector<Output> outputs{{"-o", options.output}};
  std::vector<std::filesystem::path> inputs{options.pictures.begin(), options.pictures.end()};
  if (!options.camera.empty()) inputs.emplace_back(options.camera);
  check_outputs(outputs, inputs);
  Measurer measurer(understood(options), true);
  const std::unique_ptr<Film> film = open(options);
  Track track = follow(*film, measurer);
  for (const std::string& note : measurer.notes()) track.table.comments.push_back(note);
  track.table.decimals = 5;
  const OutputFolders folders(outputs);
  write_file(options.output, track.table.csv());
  const std::string rate =
      number(film->rate(), 6) + " frames per second" + (options.fps > 0 ? "" : ", as the video says");
  if (options.json) {
    print(Json{{"output", options.output},
               {"frames", track.frames},
               {"measured", track.table.rows.size()},
               {"frames_per_second", film->rate()},
               {"mm_per_pixel", measurer.mm_per_pixel()},
               {"notes", measurer.notes()},
               {"left_out", track.lost}});
  } else {
    std::string text = "wrote " + options.output + ": " + counted(track.table.rows.size(), "frame") + " of " +
                       std::to_string(track.frames) + ", " + rate + "\n" + joined(measurer.notes(), "");
    if (!track.lost.empty()) text += "left out:\n" + joined(cut(track.lost, most_losses), "    ");
    print(text);
  }
  return track.lost.empty() ? done : not_converged;
}

}  // namespace softkin::cli
