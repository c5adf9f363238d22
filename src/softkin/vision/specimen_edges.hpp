#pragma once

#include <cmath>
#include <softkin/vision/camera.hpp>
#include <softkin/vision/pictures.hpp>

namespace softkin::vision {

/// A straight edge across a specimen.
struct SpecimenEdge {
  Vec2 place = Vec2::Zero();  // on the specimen's axis [mm]
  double position = 0;        // along the axis [mm]
  double error = 0;           // standard error of the position [mm]
  double slant = 0;           // of the edge against the normal of the axis, counter-clockwise [degrees]
  double slant_error = 0;     // standard error [degrees]
};

/// A bar of two materials A and B in two colours, as one picture shows it.
struct SpecimenView {
  SpecimenEdge fixed, interface, free;  // ends of A and B, and where they meet
  double axis = 0;                      // direction from A to B, counter-clockwise from x [degrees]

  [[nodiscard]] double length() const { return free.position - fixed.position; }                 // L [mm]
  [[nodiscard]] double interface_length() const { return interface.position - fixed.position; }  // L_1 [mm]
  [[nodiscard]] double length_error() const { return std::hypot(fixed.error, free.error); }
  [[nodiscard]] double interface_error() const { return std::hypot(fixed.error, interface.error); }
};

/// Ends and interface of the one specimen in a picture, to a fraction of a pixel: in strips along the axis the fraction
/// of one colour is summed across each edge, which blur and noise do not shift, and a line is fitted to all strips.
///
/// a, b    colours of the material at the fixed end and of the other
/// source  Fang et al. 2020, Fig. 7
/// throws  InvalidInput: a colour not there or twice, a part outside the frame, parts that do not meet, an edge that is
///         not to be seen
[[nodiscard]] SpecimenView find_specimen(const RgbImage& picture, const Colour& a, const Colour& b,
                                         const PlaneView& view);

/// What stretching did to a specimen.
struct Stretch {
  SpecimenView rest, stretched;

  // Delta L, Delta L_1 and their standard errors [mm]
  [[nodiscard]] double elongation() const { return stretched.length() - rest.length(); }
  [[nodiscard]] double shift() const { return stretched.interface_length() - rest.interface_length(); }
  [[nodiscard]] double elongation_error() const { return std::hypot(rest.length_error(), stretched.length_error()); }
  [[nodiscard]] double shift_error() const { return std::hypot(rest.interface_error(), stretched.interface_error()); }
  /// L_1 (Delta L - Delta L_1) / ((L - L_1) Delta L_1) = eps_B / eps_A = E_A / E_B of linear materials, A at the fixed
  /// end: the right-hand side of Eq. (16), which prints eps_A / eps_B on its left [-].
  [[nodiscard]] double elasticity_ratio() const;
  /// Its standard error, from those of the six edges [-].
  [[nodiscard]] double elasticity_ratio_error() const;
};

}  // namespace softkin::vision
