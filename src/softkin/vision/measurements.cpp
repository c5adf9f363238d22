#include <cmath>
#include <nlohmann/json.hpp>
#include <softkin/core/error.hpp>
#include <softkin/core/text.hpp>
#include <softkin/io/json_text.hpp>
#include <softkin/io/own_file.hpp>
#include <softkin/io/plain_text.hpp>
#include <softkin/vision/measurements.hpp>

namespace softkin::vision {

namespace {

constexpr int photo_decimals = 4, film_decimals = 5;  // of mm and degrees in files

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

void add_columns(Table& table, const std::vector<std::string>& keys) {
  for (const std::string& key : keys) table.columns.push_back({.key = key});
}

/// Comments, then the table with so many decimals of what is not whole.
std::string file_text(const Table& table, const std::vector<std::string>& comments, int decimals) {
  std::string text = "# " + std::string(made_by_softkin) + " measure\n";
  for (const std::string& line : comments) text += "# " + printable(line) + "\n";
  Table rounded{table.columns};
  for (const Row& row : table.rows) {
    Row& cells = rounded.rows.emplace_back();
    for (const Cell& cell : row) {
      const double value = std::get<double>(cell);
      cells.emplace_back(value == std::floor(value) ? number(value, 9) : decimal(value, decimals));
    }
  }
  return text + rounded.csv();
}

using Photos = std::vector<PhotoSeries::Photo>;

Table marker_table(const Photos& photos) {
  Table table;
  add_columns(table, {"picture"});
  for (const NamedMarker& marker : photos[0].seen.markers)
    add_columns(table, {marker.name + "_x_mm", marker.name + "_y_mm", marker.name + "_error_mm"});
  for (const Angle& angle : photos[0].seen.angles) add_columns(table, {angle.name + "_deg"});
  for (std::size_t i = 0; i < photos.size(); ++i) {
    Row& row = table.rows.emplace_back();
    row.emplace_back(static_cast<double>(i + 1));
    for (const NamedMarker& marker : photos[i].seen.markers)
      row.insert(row.end(), {marker.at.place.x(), marker.at.place.y(), marker.at.error});
    for (const Angle& angle : photos[i].seen.angles) row.emplace_back(angle.degrees);
  }
  return table;
}

Table specimen_table(const Photos& photos, const std::vector<Stretch>& stretches) {
  Table table;
  add_columns(table, {"l_mm", "l1_mm"});
  const double length = photos[0].seen.specimen->length(), interface = photos[0].seen.specimen->interface_length();
  if (stretches.empty()) table.rows.push_back({length, interface});
  if (!stretches.empty()) add_columns(table, {"dl_mm", "dl1_mm"});
  for (const Stretch& stretch : stretches)
    table.rows.push_back({length, interface, stretch.elongation(), stretch.shift()});
  return table;
}

Table outline_table(const Photos& photos) {
  Table table;
  add_columns(table, {"picture", "x_mm", "y_mm"});
  for (std::size_t i = 0; i < photos.size(); ++i)
    for (const Vec2& point : photos[i].seen.outline->points)
      table.rows.push_back({static_cast<double>(i + 1), point.x(), point.y()});
  return table;
}

std::vector<std::string> sources(const Photos& photos, bool specimen) {
  std::vector<std::string> lines;
  if (specimen) lines.push_back("at rest: " + photos[0].file);
  for (std::size_t i = specimen ? 1 : 0; i < photos.size(); ++i)
    lines.push_back((specimen ? "row " + std::to_string(i) : "picture " + std::to_string(i + 1)) + ": " +
                    photos[i].file);
  return lines;
}

std::vector<std::string> joined(std::vector<std::string> lines, const std::vector<std::string>& more) {
  lines.insert(lines.end(), more.begin(), more.end());
  return lines;
}

/// E_A / E_B means something only where A has been stretched by more than the error.
bool has_ratio(const Stretch& stretch) {
  return stretch.shift() > 3 * stretch.shift_error() && stretch.elongation() - stretch.shift() > 0;
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

Json outline_json(const Silhouette& outline) {
  Json x = Json::array(), y = Json::array();
  for (const Vec2& point : outline.points) x.push_back(point.x()), y.push_back(point.y());
  return {{"points", outline.points.size()},
          {"length_mm", outline.length},
          {"area_mm2", outline.area},
          {"cut", outline.cut},
          {"x_mm", x},
          {"y_mm", y}};
}

Json photo_json(const PhotoSeries::Photo& photo) {
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
  if (photo.seen.outline) json["outline"] = outline_json(*photo.seen.outline);
  return json;
}

}  // namespace

std::vector<Stretch> PhotoSeries::stretches() const {
  std::vector<Stretch> stretches;
  if (!has_specimen()) return stretches;
  for (std::size_t i = 1; i < photos_.size(); ++i)
    stretches.push_back({*photos_[0].seen.specimen, *photos_[i].seen.specimen});
  return stretches;
}

Table PhotoSeries::table() const {
  if (has_outlines()) return outline_table(photos_);
  return has_specimen() ? specimen_table(photos_, stretches()) : marker_table(photos_);
}

std::string PhotoSeries::csv() const {
  return file_text(table(), joined(sources(photos_, has_specimen()), measurer_.notes()), photo_decimals);
}

std::string PhotoSeries::json() const {
  Json json{{"mm_per_pixel", measurer_.mm_per_pixel()}, {"notes", measurer_.notes()}, {"pictures", Json::array()}};
  for (const Photo& photo : photos_) json["pictures"].push_back(photo_json(photo));
  if (!has_specimen()) return json_text(json);
  json["stretches"] = Json::array();
  for (const Stretch& s : stretches()) {
    Json each{{"dl_mm", s.elongation()},
              {"dL_error_mm", s.elongation_error()},
              {"dl1_mm", s.shift()},
              {"dL1_error_mm", s.shift_error()}};
    each["E_A_by_E_B"] = has_ratio(s) ? Json(s.elasticity_ratio()) : Json();
    each["E_A_by_E_B_error"] = has_ratio(s) ? Json(s.elasticity_ratio_error()) : Json();
    json["stretches"].push_back(std::move(each));
  }
  return json_text(json);
}

Table PhotoSeries::shown_markers() const {
  Table table{{words("picture"), words("marker"), length("x"), length("y"), length("error", 4)}};
  for (const Photo& photo : photos_)
    for (const auto& [name, at] : photo.seen.markers)
      table.rows.push_back({printable(photo.file), name, at.place.x(), at.place.y(), at.error});
  return table;
}

Table PhotoSeries::shown_angles() const {
  Table table{{words("picture"), words("angle"), column("[degrees]"), column("error"), column("since the first")}};
  for (const Photo& photo : photos_)
    for (std::size_t i = 0; i < photo.seen.angles.size(); ++i) {
      const Angle& angle = photo.seen.angles[i];
      table.rows.push_back({printable(photo.file), angle.name, angle.degrees, angle.error,
                            angle.degrees - photos_[0].seen.angles[i].degrees});
    }
  return table;
}

Table PhotoSeries::shown_specimens() const {
  Table table{{words("picture"), length("L"), length("L_1"), {.key = "interface", .unit = "degrees"}}};
  for (const Photo& photo : photos_) {
    const SpecimenView& view = *photo.seen.specimen;
    table.rows.push_back({printable(photo.file), with_error(view.length(), view.length_error(), 3),
                          with_error(view.interface_length(), view.interface_error(), 3),
                          with_error(view.interface.slant, view.interface.slant_error, 2)});
  }
  return table;
}

Table PhotoSeries::shown_stretches() const {
  Table table{{words("stretched"), length("Delta L"), length("Delta L_1"), column("E_A / E_B by Eq. (16)")}};
  const std::vector<Stretch> all = stretches();
  for (std::size_t i = 0; i < all.size(); ++i) {
    const Stretch& s = all[i];
    table.rows.push_back(
        {printable(photos_[i + 1].file), with_error(s.elongation(), s.elongation_error(), 3),
         with_error(s.shift(), s.shift_error(), 3),
         has_ratio(s) ? with_error(s.elasticity_ratio(), s.elasticity_ratio_error(), 3) : "not stretched"});
  }
  return table;
}

Table PhotoSeries::shown_outlines() const {
  Table table{{words("picture"),
               {.key = "points"},
               length("outline", 2),
               {.key = "area", .unit = "mm^2", .digits = 1, .form = Column::Form::decimals},
               words("")}};
  for (const Photo& photo : photos_) {
    const Silhouette& outline = *photo.seen.outline;
    table.rows.push_back({printable(photo.file), static_cast<std::int64_t>(outline.points.size()), outline.length,
                          outline.area, outline.cut ? "reaches the frame, where it is left out" : ""});
  }
  return table;
}

FilmTrack::FilmTrack(const MeasureOptions& options, std::vector<std::filesystem::path> files,
                     std::optional<double> rate)
    : measurer_(understood(options), true), film_(std::move(files), rate) {
  if (!options.interface.empty()) throw InvalidInput("an interface is measured in pictures, not in a film");
  if (!options.outline.empty()) throw InvalidInput("outlines are measured in pictures, not in a film");
}

bool FilmTrack::advance() {
  const std::optional<Frame> frame = film_.next();
  if (!frame) {
    if (film_.frames() > frames_ + 1)
      left_out_.push_back("the film says that it has " + std::to_string(film_.frames()) + " frames; it ends early");
    return false;
  }
  ++frames_;
  try {
    take(measurer_.measure(frame->picture, frame->name), frame->time);
  } catch (const InvalidInput& error) {
    if (frames_ == 1) throw;
    left_out_.emplace_back(error.what());
  }
  return true;
}

double FilmTrack::fraction() const {
  return film_.frames() > 0 ? double(frames_) / double(film_.frames()) : -1;
}

void FilmTrack::take(const Measurer::Seen& seen, double time) {
  if (frames_ == 1) {
    add_columns(table_, {"t_s"});
    for (const NamedMarker& marker : seen.markers) {
      markers_.push_back(marker.name);
      const std::string prefix = seen.markers.size() == 1 ? "" : marker.name + "_";
      add_columns(table_, {prefix + "x_mm", prefix + "y_mm"});
    }
    for (const Angle& angle : seen.angles) add_columns(table_, {angle.name + "_deg"});
  }
  Row& row = table_.rows.emplace_back();
  row.emplace_back(time);
  for (const NamedMarker& marker : seen.markers) row.insert(row.end(), {marker.at.place.x(), marker.at.place.y()});
  for (const Angle& angle : seen.angles) row.emplace_back(angle.degrees);
}

std::string FilmTrack::csv() const {
  return file_text(table_, measurer_.notes(), film_decimals);
}

std::string FilmTrack::json(const std::string& output) const {
  return json_text(Json{{"output", output},
                        {"frames", frames_},
                        {"measured", table_.rows.size()},
                        {"frames_per_second", rate()},
                        {"mm_per_pixel", measurer_.mm_per_pixel()},
                        {"notes", measurer_.notes()},
                        {"left_out", left_out_}});
}

}  // namespace softkin::vision
