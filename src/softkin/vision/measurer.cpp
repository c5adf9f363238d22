#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numbers>
#include <softkin/core/error.hpp>
#include <softkin/core/text.hpp>
#include <softkin/vision/measurer.hpp>
#include <utility>

namespace softkin::vision {

namespace {

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
  if (request_.outline) seen.outline = find_silhouette(picture, *request_.outline, view);
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
  if (!(distance > 2)) throw InvalidInput("scale: the two markers are less than 2 pixels apart");
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
      const double clipped = clipped_fraction(picture);
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
    // from picture to picture the smaller of both rotations, at first within half a turn
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
                                  : "lens: no camera given, distortion not taken out");
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

}  // namespace softkin::vision
