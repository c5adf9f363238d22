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

std::vector<Output> outputs_of(const std::string& output) {
  return output.empty() ? std::vector<Output>() : std::vector<Output>{{"-o", output}};
}

struct Photo {
  std::string file;
  Measurer::Seen seen;
};

/// "fixed 0.01", with the unit in the column.
std::string with_error(double value, double error, int decimals) {
  return decimal(value, decimals) + " +- " + decimal(error, decimals);
}

// ---- markers ----

NumberTable marker_table(const std::vector<Photo>& photos) {
  NumberTable table;
  table.columns = {"picture"};
  for (const NamedMarker& marker : photos[0].seen.markers)
    for (const char* column : {"_x_mm", "_y_mm", "_error_mm"}) table.columns.push_back(marker.name + column);
  for (const Angle& angle : photos[0].seen.angles) table.columns.push_back(angle.name + "_deg");
  for (std::size_t i = 0; i < photos.size(); ++i) {
    table.comments.push_back("picture " + std::to_string(i + 1) + ": " + photos[i].file);
    std::vector<double> row{static_cast<double>(i + 1)};
    for (const NamedMarker& marker : photos[i].seen.markers)
      row.insert(row.end(), {marker.at.place.x(), marker.at.place.y(), marker.at.error});
    for (const Angle& angle : photos[i].seen.angles) row.push_back(angle.degrees);
    table.rows.push_back(std::move(row));
  }
  return table;
}

std::vector<std::string> marker_lines(const std::vector<Photo>& photos) {
  std::vector<std::vector<std::string>> rows{{"picture", "marker", "x [mm]", "y [mm]", "error [mm]"}};
  for (const Photo& photo : photos)
    for (const NamedMarker& marker : photo.seen.markers)
      rows.push_back({printable(photo.file), marker.name, decimal(marker.at.place.x(), 3),
                      decimal(marker.at.place.y(), 3), decimal(marker.at.error, 4)});
  std::vector<std::string> lines = aligned(rows, "llrrr");
  if (photos[0].seen.angles.empty()) return lines;
  rows = {{"picture", "angle", "[degrees]", "error", "since the first"}};
  for (const Photo& photo : photos)
    for (std::size_t i = 0; i < photo.seen.angles.size(); ++i) {
      const Angle& angle = photo.seen.angles[i];
      rows.push_back({printable(photo.file), angle.name, decimal(angle.degrees, 2), decimal(angle.error, 2),
                      decimal(angle.degrees - photos[0].seen.angles[i].degrees, 2)});
    }
  for (std::string& line : aligned(rows, "llrrr")) lines.push_back(std::move(line));
  return lines;
}

// ---- specimens ----

/// The pictures after the first against the first.
std::vector<Stretch> stretches_of(const std::vector<Photo>& photos) {
  std::vector<Stretch> stretches;
  for (std::size_t i = 1; i < photos.size(); ++i)
    stretches.push_back({*photos[0].seen.specimen, *photos[i].seen.specimen});
  return stretches;
}

NumberTable specimen_table(const std::vector<Photo>& photos) {
  NumberTable table;
  table.comments.push_back("at rest: " + photos[0].file);
  table.columns = {"l_mm", "l1_mm", "dl_mm", "dl1_mm"};
  const std::vector<Stretch> stretches = stretches_of(photos);
  for (std::size_t i = 0; i < stretches.size(); ++i) {
    table.comments.push_back("row " + std::to_string(i + 1) + ": " + photos[i + 1].file);
    const Stretch& stretch = stretches[i];
    table.rows.push_back(
        {stretch.rest.length(), stretch.rest.interface_length(), stretch.elongation(), stretch.shift()});
  }
  if (!stretches.empty()) return table;
  table.columns = {"l_mm", "l1_mm"};
  table.rows = {{photos[0].seen.specimen->length(), photos[0].seen.specimen->interface_length()}};
  return table;
}

/// E_A / E_B means something only where A has been stretched by more than the error.
bool has_ratio(const Stretch& stretch) {
  return stretch.shift() > 3 * stretch.shift_error() && stretch.elongation() - stretch.shift() > 0;
}

std::vector<std::string> specimen_lines(const std::vector<Photo>& photos) {
  std::vector<std::vector<std::string>> rows{{"picture", "L [mm]", "L_1 [mm]", "interface [degrees]"}};
  for (const Photo& photo : photos) {
    const SpecimenView& view = *photo.seen.specimen;
    rows.push_back({printable(photo.file), with_error(view.length(), view.length_error(), 3),
                    with_error(view.interface_length(), view.interface_error(), 3),
                    with_error(view.interface.slant, view.interface.slant_error, 2)});
  }
  std::vector<std::string> lines = aligned(rows, "lrrr");
  rows = {{"stretched", "Delta L [mm]", "Delta L_1 [mm]", "E_A / E_B by Eq. (16)"}};
  const std::vector<Stretch> stretches = stretches_of(photos);
  for (std::size_t i = 0; i < stretches.size(); ++i) {
    const Stretch& s = stretches[i];
    rows.push_back({printable(photos[i + 1].file), with_error(s.elongation(), s.elongation_error(), 3),
                    with_error(s.shift(), s.shift_error(), 3),
                    has_ratio(s) ? with_error(s.elasticity_ratio(), s.elasticity_ratio_error(), 3) : "not stretched"});
  }
  if (rows.size() > 1)
    for (std::string& line : aligned(rows, "lrrr")) lines.push_back(std::move(line));
  return lines;
}

// ---- JSON ----

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

}  // namespace

int measure_photos(const MeasureOptions& options) {
  const std::vector<Output> outputs = outputs_of(options.output);
  std::vector<std::filesystem::path> inputs{options.pictures.begin(), options.pictures.end()};
  if (!options.camera.empty()) inputs.emplace_back(options.camera);
  check_outputs(outputs, inputs);
  Measurer measurer(understood(options), false);
  std::vector<Photo> photos;
  for (const std::string& file : options.pictures) photos.push_back({file, measurer.measure(read_picture(file), file)});
  const bool specimen = photos[0].seen.specimen.has_value(), markers = !photos[0].seen.markers.empty();
  const OutputFolders folders(outputs);
  if (!options.output.empty()) {
    NumberTable table = specimen ? specimen_table(photos) : marker_table(photos);
    for (const std::string& note : measurer.notes()) table.comments.push_back(note);
    write_file(options.output, table.csv());
  }
  if (options.json) {
    print(report(photos, measurer));
    return done;
  }
  std::string text;
  if (markers) text += joined(marker_lines(photos), "");
  if (specimen) text += joined(specimen_lines(photos), "");
  text += joined(measurer.notes(), "");
  print(text + (options.output.empty() ? "" : "wrote " + options.output + "\n"));
  return done;
}

}  // namespace softkin::cli
