#pragma once

#include <memory>
#include <softkin/statics/statics.hpp>

namespace softkin {

/// First-order predictions of the equilibria around one, which is factorised once for all of them.
class Neighbourhood {
 public:
  /// statics must outlive the object.
  /// at      an equilibrium that solve() returned; its actuation must be known
  /// throws  InvalidInput as Statics::sensitivity does
  Neighbourhood(const Statics& statics, const State& at, int threads = 1);
  ~Neighbourhood();
  Neighbourhood(Neighbourhood&&) noexcept;
  Neighbourhood& operator=(Neighbourhood&&) noexcept;

  /// A start for Statics::solve() at an actuation near by, a function of the arguments alone. Target shapes, and where
  /// the stiffness has no inverse: the equilibrium itself.
  ///
  /// throws  InvalidInput as check_actuation does
  [[nodiscard]] State predict(const Actuation& actuation);

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace softkin
