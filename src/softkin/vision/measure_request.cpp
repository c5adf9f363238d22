#include <cmath>
#include <cstdlib>
#include <set>
#include <softkin/core/error.hpp>
#include <softkin/vision/measure_request.hpp>
#include <utility>

namespace softkin::vision {

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
      throw InvalidInput(std::string("dots: ") + error.what());
    }
    add_name(names, name, "dots");
    if (!colours.insert(colour).second)
      throw InvalidInput("dots: two markers are " + colour + "; each needs a colour of its own");
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
    if (!tag) throw InvalidInput("tags: '" + number + "' is no number of a tag");
    if (*tag >= dictionary_size(request.given.dictionary))
      throw InvalidInput("tags: dictionary " + request.given.dictionary + " has no tag " + number + ", only 0 to " +
                         std::to_string(dictionary_size(request.given.dictionary) - 1));
    const std::string name = given.value_or("tag" + std::to_string(*tag));
    add_name(names, name, "tags");
    if (!request.tags.emplace(*tag, name).second) throw InvalidInput("tags: tag " + number + " is given twice");
  }
}

SilhouetteLook read_outline(const std::string& text) {
  try {
    return SilhouetteLook(text);
  } catch (const InvalidInput& error) {
    throw InvalidInput(std::string("outline: ") + error.what() + ", dark or bright");
  }
}

ScaleRequest read_scale(const std::string& text) {
  const std::size_t equals = text.rfind('=');
  const std::vector<std::string> parts = parts_of(text.substr(0, equals));
  if (equals == std::string::npos || (parts.size() != 2 && parts.size() != 4))
    throw InvalidInput("scale '" + text + "': write two markers, a,b=25mm, or two pixels, x1,y1,x2,y2=25mm");
  ScaleRequest scale;
  scale.length = parse_length(text.substr(equals + 1), "scale: the distance");
  if (parts.size() == 2) {
    scale.markers = {parts[0], parts[1]};
    return scale;
  }
  std::array<double, 4> values{};
  for (std::size_t i = 0; i < 4; ++i) {
    char* end = nullptr;
    values[i] = std::strtod(parts[i].c_str(), &end);
    if (end == parts[i].c_str() || *end != '\0' || !(std::abs(values[i]) < 1e6))
      throw InvalidInput("scale: '" + parts[i] + "' is no coordinate in pixels");
  }
  scale.pixels = {Vec2(values[0], values[1]), Vec2(values[2], values[3])};
  if (((*scale.pixels)[0] - (*scale.pixels)[1]).norm() < 2)
    throw InvalidInput("scale: the two points are less than 2 pixels apart");
  return scale;
}

/// All tags are known by name only when the first picture has been seen.
void check_marker(const MeasureRequest& request, const std::set<std::string>& names, const std::string& name,
                  const std::string& option) {
  if (names.contains(name) || (request.all_tags && name.starts_with("tag"))) return;
  throw InvalidInput(option + ": no marker '" + name + "'" + suggest_name(name, {names.begin(), names.end()}));
}

void read_frame(MeasureRequest& request, const MeasureOptions& options, const std::set<std::string>& names) {
  if (!options.origin.empty()) check_marker(request, names, options.origin, "origin");
  if (options.x_axis.empty()) return;
  const std::vector<std::string> parts = parts_of(options.x_axis);
  if (parts.size() != 2 || parts[0] == parts[1])
    throw InvalidInput("x axis '" + options.x_axis + "': give two markers, a,b; x goes from the first to the second");
  for (const std::string& part : parts) check_marker(request, names, part, "x axis");
  request.x_axis = {parts[0], parts[1]};
}

void check_whole(const MeasureRequest& request) {
  if (request.board.has_value() == request.scale.has_value())
    throw InvalidInput("give one of the two, a board of known size or a scale: without a scale there are no mm");
  if (request.board && request.board->kind == BoardSpec::Kind::checker)
    throw InvalidInput("scale board: a checker board looks the same upside down; use a grid or charuco board");
  const bool markers = !request.dots.empty() || !request.tags.empty() || request.all_tags;
  if (!markers && !request.interface && !request.outline)
    throw InvalidInput("nothing to measure: give dots, tags, an interface or an outline");
  if (request.interface && request.outline)
    throw InvalidInput("an interface and an outline have tables of their own; measure them in two calls");
  if (request.given.moving_camera && !request.board)
    throw InvalidInput("a moving camera needs a scale board, by which each frame finds where the camera is");
  if (request.interface && markers && !request.angles.empty())
    throw InvalidInput("an interface has its own angles; measure those of markers in a call of its own");
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
      throw InvalidInput("interface '" + options.interface + "': give two colours, that at the fixed end first");
    request.interface = {Colour(parts[0]), Colour(parts[1])};
  }
  if (!options.outline.empty()) request.outline = read_outline(options.outline);
  if (request.scale && !request.scale->pixels)
    for (const std::string& marker : request.scale->markers) check_marker(request, names, marker, "scale");
  for (const std::string& angle : options.angles) {
    const std::vector<std::string> parts = parts_of(angle);
    if ((parts.size() != 2 && parts.size() != 4) || parts[0] == parts[1] || (parts.size() == 4 && parts[2] == parts[3]))
      throw InvalidInput("angle '" + angle + "': give two markers, a,b, or two pairs of them, a,b,c,d");
    for (const std::string& part : parts) check_marker(request, names, part, "angle");
    request.angles.push_back({parts});
  }
  read_frame(request, options, names);
  check_whole(request);
  if (options.lens)
    request.camera = options.lens;
  else if (!options.camera.empty())
    request.camera = read_camera(options.camera);
  return request;
}

}  // namespace softkin::vision
