#include "measure.hpp"

#include <softkin/core/text.hpp>
#include <softkin/io/file.hpp>
#include <softkin/vision/measurements.hpp>

#include "cli/command.hpp"
#include "cli/terminal.hpp"

namespace softkin::cli {

using vision::FilmTrack;
using vision::PhotoSeries;

namespace {

constexpr std::size_t max_losses = 5;

/// What is written, checked against what is read.
std::vector<Output> checked_outputs(const PicturesOptions& options) {
  std::vector<Output> outputs;
  if (!options.output.empty()) outputs.push_back({"-o", options.output});
  std::vector<std::filesystem::path> inputs{options.pictures.begin(), options.pictures.end()};
  if (!options.camera.empty()) inputs.emplace_back(options.camera);
  check_outputs(outputs, inputs, options.may_replace);
  return outputs;
}

std::string text_of(const PhotoSeries& series) {
  std::string text;
  const auto add = [&text](const Table& table) {
    if (!table.rows.empty()) text += table_text(table);
  };
  add(series.shown_markers());
  add(series.shown_angles());
  if (series.has_specimen()) {
    add(series.shown_specimens());
    add(series.shown_stretches());
  }
  if (series.has_outlines()) add(series.shown_outlines());
  return text + joined(series.measurer().notes(), "");
}

}  // namespace

int measure_photos(const PicturesOptions& options) {
  const std::vector<Output> outputs = checked_outputs(options);
  PhotoSeries series(options);
  for (const std::string& file : options.pictures) series.add(vision::read_picture(file), file);
  const OutputFolders folders(outputs);
  if (!options.output.empty()) write_file(options.output, series.csv());
  if (options.json)
    print(series.json() + "\n");
  else
    print(text_of(series) + (options.output.empty() ? "" : "wrote " + options.output + "\n"));
  return done;
}

int measure_film(const PicturesOptions& options) {
  const std::vector<Output> outputs = checked_outputs(options);
  FilmTrack track(options, {options.pictures.begin(), options.pictures.end()},
                  options.fps > 0 ? std::optional(options.fps) : std::nullopt);
  {
    ProgressLine progress;
    while (track.advance()) progress.show(track.fraction(), "frame " + std::to_string(track.frames()));
  }
  const OutputFolders folders(outputs);
  write_file(options.output, track.csv());
  if (options.json) {
    print(track.json(options.output) + "\n");
  } else {
    std::string text = "wrote " + options.output + ": " + counted(track.table().rows.size(), "frame") + " of " +
                       std::to_string(track.frames()) + ", " + number(track.rate(), 6) + " frames per second" +
                       (options.fps > 0 ? "" : ", as the video says") + "\n" + joined(track.measurer().notes(), "");
    if (!track.left_out().empty()) text += "left out:\n" + joined(cut(track.left_out(), max_losses), "    ");
    print(text);
  }
  return track.left_out().empty() ? done : not_converged;
}

}  // namespace softkin::cli
