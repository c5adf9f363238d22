#include <cmath>
#include <nlohmann/json.hpp>
#include <softkin/core/error.hpp>
#include <softkin/io/file.hpp>
#include <softkin/io/json_text.hpp>
#include <softkin/io/plain_text.hpp>
#include <softkin/io/table/table.hpp>
#include <softkin/vision/pictures.hpp>

#include "cli/command.hpp"
#include "cli/terminal.hpp"
#include "measurer.hpp"

namespace softkin::cli {

namespace {

constexpr std::size_t most_losses = 5;

/// What is written, checked against what is read.
std::vector<Output> checked_outputs(const MeasureOptions& options) {
  std::vector<Output> outputs;
  if (!options.output.empty()) outputs.push_back({"-o", options.output});
  std::vector<std::filesystem::path> inputs{options.pictures.begin(), options.pictures.end()};
  if (!options.camera.empty()) inputs.emplace_back(options.camera);
  check_outputs(outputs, inputs);
  return outputs;
}

Column words(const std::string& title) {
  return {.key = title, .left = true};
}

Column length(const std::string& title, int digits = 3) {
  return {.key = title, .unit = "mm", .digits = digits, .form = Column::Form::decimals};
}

Column column(const std::string& title, int digits = 2) {
  return {.key = title, .digits = digits, .form = Column::Form::decimals};
}

/// "fixed 0.01", with the unit in the column.
std::string with_error(double value, double error, int decimals) {
  return decimal(value, decimals) + " +- " + decimal(error, decimals);
}

/// A table of numbers for a file, with comments above.
struct NumberTable {
  std::vector<std::string> comments{};
  Table table{};

  void add_columns(const std::vector<std::string>& keys) {
    for (const std::string& key : keys) table.columns.push_back({.key = key});
  }
  /// decimals: of what is not whole
  void add_row(const std::vector<double>& values, int decimals) {
    Row& row = table.rows.emplace_back();
    for (const double value : values)
      row.emplace_back(value == std::floor(value) ? number(value, 9) : decimal(value, decimals));
  }
  void write(const std::string& file, const std::vector<std::string>& notes) const {
    std::string text;
    for (const auto* lines : {&comments, &notes})
      for (const std::string& line : *lines) text += "# " + printable(line) + "\n";
    write_file(file, text + table.csv());
  }
};

// ---- pictures ----

struct Photo {
  std::string file;
  Measurer::Seen seen;
};

NumberTable marker_table(const std::vector<Photo>& photos) {
  NumberTable result;
  result.add_columns({"picture"});
  for (const NamedMarker& marker : photos[0].seen.markers)
    result.add_columns({marker.name + "_x_mm", marker.name + "_y_mm", marker.name + "_error_mm"});
  for (const Angle& angle : photos[0].seen.angles) result.add_columns({angle.name + "_deg"});
  for (std::size_t i = 0; i < photos.size(); ++i) {
    result.comments.push_back("picture " + std::to_string(i + 1) + ": " + photos[i].file);
    std::vector<double> row{static_cast<double>(i + 1)};
    for (const NamedMarker& marker : photos[i].seen.markers)
      row.insert(row.end(), {marker.at.place.x(), marker.at.place.y(), marker.at.error});
    for (const Angle& angle : photos[i].seen.angles) row.push_back(angle.degrees);
    result.add_row(row, 4);
  }
  return result;
}

std::string marker_text(const std::vector<Photo>& photos) {
  Table places{{words("picture"), words("marker"), length("x"), length("y"), length("error", 4)}};
  Table angles{{words("picture"), words("angle"), column("[degrees]"), column("error"), column("since the first")}};
  for (const Photo& photo : photos) {
    for (const auto& [name, at] : photo.seen.markers)
      places.rows.push_back({printable(photo.file), name, at.place.x(), at.place.y(), at.error});
    for (std::size_t i = 0; i < photo.seen.angles.size(); ++i) {
      const Angle& angle = photo.seen.angles[i];
      angles.rows.push_back({printable(photo.file), angle.name, angle.degrees, angle.error,
                             angle.degrees - photos[0].seen.angles[i].degrees});
    }
  }
  return table_text(places) + (angles.rows.empty() ? "" : table_text(angles));
}

/// The pictures after the first against the first.
std::vector<Stretch> stretches_of(const std::vector<Photo>& photos) {
  std::vector<Stretch> stretches;
  for (std::size_t i = 1; i < photos.size(); ++i)
    stretches.push_back({*photos[0].seen.specimen, *photos[i].seen.specimen});
  return stretches;
}

NumberTable specimen_table(const std::vector<Photo>& photos) {
  NumberTable result;
  result.comments.push_back("at rest: " + photos[0].file);
  result.add_columns({"l_mm", "l1_mm"});
  const double length = photos[0].seen.specimen->length(), interface = photos[0].seen.specimen->interface_length();
  const std::vector<Stretch> stretches = stretches_of(photos);
  if (stretches.empty()) {
    result.add_row({length, interface}, 4);
    return result;
  }
  result.add_columns({"dl_mm", "dl1_mm"});
  for (std::size_t i = 0; i < stretches.size(); ++i) {
    result.comments.push_back("row " + std::to_string(i + 1) + ": " + photos[i + 1].file);
    result.add_row({length, interface, stretches[i].elongation(), stretches[i].shift()}, 4);
  }
  return result;
}

/// E_A / E_B means something only where A has been stretched by more than the error.
bool has_ratio(const Stretch& stretch) {
  return stretch.shift() > 3 * stretch.shift_error() && stretch.elongation() - stretch.shift() > 0;
}

std::string specimen_text(const std::vector<Photo>& photos) {
  Table parts{{words("picture"), length("L"), length("L_1"), {.key = "interface", .unit = "degrees"}}};
  for (const Photo& photo : photos) {
    const SpecimenView& view = *photo.seen.specimen;
    parts.rows.push_back({printable(photo.file), with_error(view.length(), view.length_error(), 3),
                          with_error(view.interface_length(), view.interface_error(), 3),
                          with_error(view.interface.slant, view.interface.slant_error, 2)});
  }
  Table moves{{words("stretched"), length("Delta L"), length("Delta L_1"), column("E_A / E_B by Eq. (16)")}};
  const std::vector<Stretch> stretches = stretches_of(photos);
  for (std::size_t i = 0; i < stretches.size(); ++i) {
    const Stretch& s = stretches[i];
    moves.rows.push_back(
        {printable(photos[i + 1].file), with_error(s.elongation(), s.elongation_error(), 3),
         with_error(s.shift(), s.shift_error(), 3),
         has_ratio(s) ? with_error(s.elasticity_ratio(), s.elasticity_ratio_error(), 3) : "not stretched"});
  }
  return table_text(parts) + (stretches.empty() ? "" : table_text(moves));
}

Json specimen_json(const SpecimenView& view) {
  return {{"l_mm", view.length()},
          {"L_error_mm", view.length_error()},
          {"l1_mm", view.interface_length()},
          {"L1_error_mm", view.interface_error()},
          {"interface_deg", view.interface.slant},
          {"interface_error_deg", view.interface.slant_error},
          {"axis_deg", view.axis}};
}

Json photo_json(const Photo& photo) {
  Json json{{"picture", photo.file}};
  for (const NamedMarker& marker : photo.seen.markers)
    json["markers"][marker.name] = {{"x_mm", marker.at.place.x()},
                                    {"y_mm", marker.at.place.y()},
                                    {"error_mm", marker.at.error},
                                    {"x_px", marker.at.pixel.x()},
                                    {"y_px", marker.at.pixel.y()}};
  for (const Angle& angle : photo.seen.angles)
    json["angles"][angle.name] = {{"degrees", angle.degrees}, {"error_deg", angle.error}};
  if (photo.seen.specimen) json["specimen"] = specimen_json(*photo.seen.specimen);
  return json;
}

Json report(const std::vector<Photo>& photos, const Measurer& measurer) {
  Json json{{"mm_per_pixel", measurer.mm_per_pixel()}, {"notes", measurer.notes()}, {"pictures", Json::array()}};
  for (const Photo& photo : photos) json["pictures"].push_back(photo_json(photo));
  if (!photos[0].seen.specimen) return json;
  json["stretches"] = Json::array();
  for (const Stretch& s : stretches_of(photos)) {
    Json each{{"dl_mm", s.elongation()},
              {"dL_error_mm", s.elongation_error()},
              {"dl1_mm", s.shift()},
              {"dL1_error_mm", s.shift_error()}};
    each["E_A_by_E_B"] = has_ratio(s) ? Json(s.elasticity_ratio()) : Json();
    each["E_A_by_E_B_error"] = has_ratio(s) ? Json(s.elasticity_ratio_error()) : Json();
    json["stretches"].push_back(std::move(each));
  }
  return json;
}

// ---- films ----

struct Track {
  NumberTable numbers;
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
      if (track.frames == 1) {
        track.numbers.add_columns({"t_s"});
        for (const NamedMarker& marker : seen.markers) {
          const std::string prefix = seen.markers.size() == 1 ? "" : marker.name + "_";
          track.numbers.add_columns({prefix + "x_mm", prefix + "y_mm"});
        }
        for (const Angle& angle : seen.angles) track.numbers.add_columns({angle.name + "_deg"});
      }
      track.numbers.add_row(row, 5);
    } catch (const InvalidInput& error) {
      if (track.frames == 1) throw;
      track.lost.emplace_back(error.what());
    }
  }
  if (film.frames() > track.frames + 1)
    track.lost.push_back("the film says that it has " + std::to_string(film.frames()) + " frames; it ends early");
  return track;
}

}  // namespace

int measure_photos(const MeasureOptions& options) {
  const std::vector<Output> outputs = checked_outputs(options);
  Measurer measurer(understood(options), false);
  std::vector<Photo> photos;
  for (const std::string& file : options.pictures) photos.push_back({file, measurer.measure(read_picture(file), file)});
  const bool specimen = photos[0].seen.specimen.has_value(), markers = !photos[0].seen.markers.empty();
  const OutputFolders folders(outputs);
  if (!options.output.empty())
    (specimen ? specimen_table(photos) : marker_table(photos)).write(options.output, measurer.notes());
  if (options.json) {
    print(json_text(report(photos, measurer)) + "\n");
    return done;
  }
  std::string text;
  if (markers) text += marker_text(photos);
  if (specimen) text += specimen_text(photos);
  text += joined(measurer.notes(), "");
  print(text + (options.output.empty() ? "" : "wrote " + options.output + "\n"));
  return done;
}

int measure_film(const MeasureOptions& options) {
  const std::vector<Output> outputs = checked_outputs(options);
  Measurer measurer(understood(options), true);
  Film film({options.pictures.begin(), options.pictures.end()},
            options.fps > 0 ? std::optional(options.fps) : std::nullopt);
  const Track track = follow(film, measurer);
  const std::size_t measured = track.numbers.table.rows.size();
  const OutputFolders folders(outputs);
  track.numbers.write(options.output, measurer.notes());
  const std::string rate =
      number(film.rate(), 6) + " frames per second" + (options.fps > 0 ? "" : ", as the video says");
  if (options.json) {
    const Json json{{"output", options.output},
                    {"frames", track.frames},
                    {"measured", measured},
                    {"frames_per_second", film.rate()},
                    {"mm_per_pixel", measurer.mm_per_pixel()},
                    {"notes", measurer.notes()},
                    {"left_out", track.lost}};
    print(json_text(json) + "\n");
  } else {
    std::string text = "wrote " + options.output + ": " + counted(measured, "frame") + " of " +
                       std::to_string(track.frames) + ", " + rate + "\n" + joined(measurer.notes(), "");
    if (!track.lost.empty()) text += "left out:\n" + joined(cut(track.lost, most_losses), "    ");
    print(text);
  }
  return track.lost.empty() ? done : not_converged;
}

}  // namespace softkin::cli
