#include "measurer.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numbers>
#include <set>
#include <softkin/core/error.hpp>
#include <softkin/vision/boards.hpp>
#include <utility>

#include "cli/terminal.hpp"

namespace softkin::cli {

namespace {

/// Names become columns of a table.
void add_name(std::set<std::string>& names, const std::string& name, const std::string& option) {
  const bool word =
      !name.empty() && name.size() <= 60 && name.find_first_not_of("0123456789") != std::string::npos &&
      name.find_first_not_of("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-#") == std::string::npos;
  if (!word) throw InvalidInput(option + ": '" + name + "' is no name; use letters, digits, _ and -");
  if (!names.insert(name).second)
    throw InvalidInput(option + ": there are two markers '" + name + "'; name one: tip=red");
}

/// "tip=red": a name, if one is given, and what it names.
std::pair<std::optional<std::string>, std::string> split_name(const std::string& part) {
  const std::size_t equals = part.find('=');
  if (equals == std::string::npos) return {std::nullopt, part};
  return {part.substr(0, equals), part.substr(equals + 1)};
}

void read_dots(MeasureRequest& request, const std::string& text, std::set<std::string>& names) {
  std::set<std::string> colours;
  for (const std::string& part : parts_of(text)) {
    const auto [given, colour] = split_name(part);
    const std::string name = given.value_or(colour);
    try {
      request.dots.push_back({name, Colour(colour)});
    } catch (const InvalidInput& error) {
      throw InvalidInput(std::string("--dots: ") + error.what());
    }
    add_name(names, name, "--dots");
    if (!colours.insert(colour).second)
      throw InvalidInput("--dots: two markers are " + colour + "; each needs a colour of its own");
  }
}

void read_tags(MeasureRequest& request, const std::string& text, std::set<std::string>& names) {
  if (text == "true") {  // the bare flag
    request.all_tags = true;
    return;
  }
  for (const std::string& part : parts_of(text)) {
    const auto [given, number] = split_name(part);
    const std::optional<int> tag = whole_number(number);
    if (!tag) throw InvalidInput("--tags: '" + number + "' is no number of a tag");
    if (*tag >= dictionary_size(request.given.dictionary))
      throw InvalidInput("--tags: dictionary " + request.given.dictionary + " has no tag " + number + ", only 0 to " +
                         std::to_string(dictionary_size(request.given.dictionary) - 1));
    const std::string name = given.value_or("tag" + std::to_string(*tag));
    add_name(names, name, "--tags");
    if (!request.tags.emplace(*tag, name).second) throw InvalidInput("--tags: tag " + number + " is given twice");
  }
}

ScaleRequest read_scale(const std::string& text) {
  const std::size_t equals = text.rfind('=');
  const std::vector<std::string> parts = parts_of(text.substr(0, equals));
  if (equals == std::string::npos || (parts.size() != 2 && parts.size() != 4))
    throw InvalidInput("--scale '" + text + "': write two markers, a,b=25mm, or two pixels, x1,y1,x2,y2=25mm");
  ScaleRequest scale;
  scale.length = parse_length(text.substr(equals + 1), "--scale: the distance");
  if (parts.size() == 2) {
    scale.markers = {parts[0], parts[1]};
    return scale;
  }
  std::array<double, 4> values{};
  for (std::size_t i = 0; i < 4; ++i) {
    char* end = nullptr;
    values[i] = std::strtod(parts[i].c_str(), &end);
    if (end == parts[i].c_str() || *end != '\0' || !(std::abs(values[i]) < 1e6))
      throw InvalidInput("--scale: '" + parts[i] + "' is no coordinate in pixels");
  }
  scale.pixels = {Vec2(values[0], values[1]), Vec2(values[2], values[3])};
  if (((*scale.pixels)[0] - (*scale.pixels)[1]).norm() < 2)
    throw InvalidInput("--scale: the two points are less than 2 pixels apart");
  return scale;
}

/// All tags are known by name only when the first picture has been seen.
void check_marker(const MeasureRequest& request, const std::set<std::string>& names, const std::string& name,
                  const std::string& option) {
  if (names.contains(name) || (request.all_tags && name.starts_with("tag"))) return;
  throw InvalidInput(option + ": no marker '" + name + "'" + suggest_name(name, {names.begin(), names.end()}));
}

void read_frame(MeasureRequest& request, const MeasureOptions& options, const std::set<std::string>& names) {
  if (!options.origin.empty()) check_marker(request, names, options.origin, "--origin");
  if (options.x_axis.empty()) return;
  const std::vector<std::string> parts = parts_of(options.x_axis);
  if (parts.size() != 2 || parts[0] == parts[1])
    throw InvalidInput("--x-axis '" + options.x_axis + "': give two markers, a,b; x goes from the first to the second");
  for (const std::string& part : parts) check_marker(request, names, part, "--x-axis");
  request.x_axis = {parts[0], parts[1]};
}

void check_whole(const MeasureRequest& request) {
  if (request.board.has_value() == request.scale.has_value())
    throw InvalidInput("give one of --scale-board and --scale: without a scale there are no mm");
  if (request.board && request.board->kind == BoardSpec::Kind::checker)
    throw InvalidInput("--scale-board: a checker board looks the same upside down; use a grid or charuco board");
  const bool markers = !request.dots.empty() || !request.tags.empty() || request.all_tags;
  if (!markers && !request.interface) throw InvalidInput("nothing to measure: give --dots, --tags or --interface");
  if (request.given.moving_camera && !request.board)
    throw InvalidInput("--moving-camera needs --scale-board, by which each frame finds where the camera is");
  if (request.interface && markers && !request.angles.empty())
    throw InvalidInput("--interface prints its own angles; measure those of markers in a call of its own");
}

constexpr double tag_error = 0.05;     // standard error of a tag's centre, from pictures with known answers [px]
constexpr double clicked_error = 0.5;  // of a pixel that the user read off a screen [px]

const MarkerPlace& named(const std::vector<NamedMarker>& markers, const std::string& name) {
  for (const NamedMarker& marker : markers)
    if (marker.name == name) return marker.at;
  std::vector<std::string> names;
  for (const NamedMarker& marker : markers) names.push_back(marker.name);
  throw InvalidInput("no marker '" + name + "' found" + suggest_name(name, names));
}

/// Direction of a line [degrees], and its standard error.
std::pair<double, double> direction(const MarkerPlace& from, const MarkerPlace& to) {
  const Vec2 line = to.place - from.place;
  constexpr double degrees = 180 / std::numbers::pi;
  return {std::atan2(line.y(), line.x()) * degrees, std::hypot(from.error, to.error) / line.norm() * degrees};
}

}  // namespace

std::string AngleRequest::name() const {
  std::string name = "angle";
  for (const std::string& marker : markers) name += "_" + marker;
  return name;
}

MeasureRequest understood(const MeasureOptions& options) {
  MeasureRequest request;
  std::set<std::string> names;
  request.given = options;
  if (!options.board.empty()) request.board = parse_board(options.board);
  if (options.dictionary.empty()) request.given.dictionary = (request.board ? *request.board : BoardSpec()).dictionary;
  (void)dictionary_size(request.given.dictionary);
  if (!options.dots.empty()) read_dots(request, options.dots, names);
  if (!options.tags.empty()) read_tags(request, options.tags, names);
  if (!options.scale.empty()) request.scale = read_scale(options.scale);
  if (!options.interface.empty()) {
    const std::vector<std::string> parts = parts_of(options.interface);
    if (parts.size() != 2 || parts[0] == parts[1])
      throw InvalidInput("--interface '" + options.interface + "': give two colours, that at the fixed end first");
    request.interface = {Colour(parts[0]), Colour(parts[1])};
  }
  if (request.scale && !request.scale->pixels)
    for (const std::string& marker : request.scale->markers) check_marker(request, names, marker, "--scale");
  for (const std::string& angle : options.angles) {
    const std::vector<std::string> parts = parts_of(angle);
    if ((parts.size() != 2 && parts.size() != 4) || parts[0] == parts[1] || (parts.size() == 4 && parts[2] == parts[3]))
      throw InvalidInput("--angle '" + angle + "': give two markers, a,b, or two pairs of them, a,b,c,d");
    for (const std::string& part : parts) check_marker(request, names, part, "--angle");
    request.angles.push_back({parts});
  }
  read_frame(request, options, names);
  check_whole(request);
  if (!options.camera.empty()) request.camera = read_camera(options.camera);
  return request;
}

Measurer::Seen Measurer::measure(const RgbImage& picture, const std::string& file) {
  try {
    return in_picture(picture);
  } catch (const InvalidInput& error) {
    throw InvalidInput({file}, error.what());
  }
}

Measurer::Seen Measurer::in_picture(const RgbImage& picture) {
  if (request_.camera && (picture.width != request_.camera->width || picture.height != request_.camera->height))
    throw InvalidInput("the picture has " + std::to_string(picture.width) + " x " + std::to_string(picture.height) +
                       " pixels, but the camera " + request_.given.camera + " was found from pictures of " +
                       std::to_string(request_.camera->width) + " x " + std::to_string(request_.camera->height));
  const PlaneView plain = view_of(picture);
  if (first_) {
    const std::vector<NamedMarker> markers = markers_in(picture, plain);
    if (!request_.given.origin.empty()) origin_ = named(markers, request_.given.origin).place;
    if (!request_.x_axis[0].empty())
      turn_ = direction(named(markers, request_.x_axis[0]), named(markers, request_.x_axis[1])).first *
              std::numbers::pi / 180;
    const Vec2 middle(picture.width / 2.0, picture.height / 2.0);
    mm_per_pixel_ = std::sqrt(plain.pixel_area(middle));
    for (const NamedMarker& marker : markers) {  // the same ones in all pictures
      const bool tag = std::none_of(request_.dots.begin(), request_.dots.end(),
                                    [&](const DotRequest& dot) { return dot.name == marker.name; });
      if (request_.all_tags && tag) request_.tags.emplace(std::atoi(marker.name.c_str() + 3), marker.name);
    }
    request_.all_tags = false;
    first_ = false;
  }
  const PlaneView view = plain.moved(origin_, turn_);
  Seen seen;
  seen.markers = markers_in(picture, view);
  if (request_.interface)
    seen.specimen = find_specimen(picture, (*request_.interface)[0], (*request_.interface)[1], view);
  seen.angles = angles_of(seen.markers);
  return seen;
}

PlaneView Measurer::view_of(const RgbImage& picture) {
  if (view_) return *view_;
  if (request_.scale) {
    view_ = scaled(picture);
    return *view_;
  }
  const PlaneView view(request_.camera, find_board(picture, *request_.board, request_.camera));
  board_residual_ = std::max(board_residual_, view.residual());
  if (film_ && !request_.given.moving_camera) view_ = view;
  return view;
}

/// The origin at the first of the two points.
PlaneView Measurer::scaled(const RgbImage& picture) {
  const PlaneView pixels(request_.camera, 1.0);
  Vec2 a, b;
  double error = 0;
  if (request_.scale->pixels) {
    a = pixels.to_mm((*request_.scale->pixels)[0]);
    b = pixels.to_mm((*request_.scale->pixels)[1]);
    error = std::sqrt(2.0) * clicked_error;
  } else {
    const std::vector<NamedMarker> markers = markers_in(picture, pixels);
    const MarkerPlace &from = named(markers, request_.scale->markers[0]),
                      &to = named(markers, request_.scale->markers[1]);
    a = from.place;
    b = to.place;
    error = std::hypot(from.error, to.error);
  }
  const double distance = (b - a).norm();
  if (!(distance > 2)) throw InvalidInput("--scale: the two markers are less than 2 pixels apart");
  const double mm = request_.scale->length / distance;
  scale_error_ = error / distance;
  return PlaneView(request_.camera, mm).moved(mm * a, 0);
}

std::vector<NamedMarker> Measurer::markers_in(const RgbImage& picture, const PlaneView& view) {
  std::vector<NamedMarker> markers;
  for (const DotRequest& dot : request_.dots)
    markers.push_back({dot.name, find_dot(picture, dot.colour, view, dot.name)});
  if (!request_.tags.empty() || request_.all_tags) append_tags(markers, picture, view);
  return markers;
}

void Measurer::append_tags(std::vector<NamedMarker>& markers, const RgbImage& picture, const PlaneView& view) {
  const std::vector<Tag> tags = find_tags(picture, request_.given.dictionary, request_.camera);
  std::map<int, const Tag*> found;
  for (const Tag& tag : tags) {
    const bool on_board = request_.board && request_.board->dictionary == request_.given.dictionary &&
                          tag.number >= request_.board->first &&
                          tag.number < request_.board->first + request_.board->tags();
    if (request_.all_tags ? on_board : !request_.tags.contains(tag.number)) continue;
    if (!found.emplace(tag.number, &tag).second)
      throw InvalidInput("two candidates for tag " + std::to_string(tag.number) + ": at (" +
                         decimal(found[tag.number]->centre().x(), 0) + ", " +
                         decimal(found[tag.number]->centre().y(), 0) + ") and (" + decimal(tag.centre().x(), 0) + ", " +
                         decimal(tag.centre().y(), 0) + ")");
  }
  if (request_.all_tags && found.empty())
    throw InvalidInput("no tag of dictionary " + request_.given.dictionary + " found" +
                       (request_.board ? " beside those of the board" : ""));
  std::map<int, std::string> wanted = request_.tags;
  if (request_.all_tags)
    for (const auto& [number, tag] : found) wanted.emplace(number, "tag" + std::to_string(number));
  for (const auto& [number, name] : wanted) {
    if (!found.contains(number)) {
      const double clipped = clipped_share(picture);
      throw InvalidInput(
          "tag " + std::to_string(number) + (name == "tag" + std::to_string(number) ? "" : " '" + name + "'") +
          " not found; all of it must be in the picture, sharp, with a light margin around" +
          (clipped > 0.3 ? " (the picture is over-exposed: " + decimal(100 * clipped, 0) + " % of it is white)" : ""));
    }
    MarkerPlace place;
    const Vec2 centre = found[number]->centre();
    place.pixel = request_.camera ? distorted(*request_.camera, centre) : centre;
    place.place = view.ideal_to_mm(centre);
    place.error = std::hypot(tag_error * std::sqrt(view.pixel_area(place.pixel)), view.error_at(place.pixel));
    markers.push_back({name, place});
  }
}

std::vector<Angle> Measurer::angles_of(const std::vector<NamedMarker>& markers) {
  std::vector<Angle> angles;
  for (const AngleRequest& request : request_.angles) {
    const auto& m = request.markers;
    auto [degrees, error] = direction(named(markers, m[0]), named(markers, m[1]));
    if (m.size() == 4) {
      const auto [second, second_error] = direction(named(markers, m[2]), named(markers, m[3]));
      degrees = second - degrees;
      error = std::hypot(error, second_error);
    }
    // from picture to picture the shorter way round, at first within half a turn
    const double last = last_angles_.contains(request.name()) ? last_angles_[request.name()] : 0;
    degrees = last + std::remainder(degrees - last, 360.0);
    last_angles_[request.name()] = degrees;
    angles.push_back({request.name(), degrees, error});
  }
  return angles;
}

std::vector<std::string> Measurer::notes() const {
  std::vector<std::string> notes;
  std::string scale = "scale: " + number(mm_per_pixel_, 5) + " mm per pixel in the middle of the first picture";
  if (request_.board)
    scale += "; the board fits to " + decimal(board_residual_, 3) + " pixels" +
             (film_ && !request_.given.moving_camera ? " in the first frame, which holds for all" : "");
  else
    scale += ", standard error " + decimal(100 * scale_error_, 3) +
             " %; it holds for all pictures, and for a camera that looks straight at the plane";
  notes.push_back(scale);
  notes.push_back(request_.camera ? "lens: distortion taken out by " + request_.given.camera
                                  : "lens: no --camera given, distortion not taken out");
  const std::string origin = !request_.given.origin.empty()
                                 ? "marker '" + request_.given.origin + "' in the first picture"
                             : request_.board ? "the lower left corner of the board"
                                              : "the first point of the scale";
  const std::string axis = !request_.x_axis[0].empty() ? "from " + request_.x_axis[0] + " to " + request_.x_axis[1]
                           : request_.board            ? "to the right on the board"
                                                       : "to the right in the picture";
  notes.push_back("axes: x " + axis + ", y up, origin at " + origin);
  return notes;
}

}  // namespace softkin::cli
