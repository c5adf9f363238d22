#include <cmath>
#include <softkin/core/error.hpp>
#include <softkin/statics/statics_parts.hpp>

namespace softkin {

namespace {

double change_of(const ShapeGradient& reported, const ParameterSensitivity& found, Index number) {
  double sum = 0;
  if (reported.by_places.rows() > 0) sum += reported.by_places.cwiseProduct(found.positions[number]).sum();
  if (reported.by_loads.size() > 0) sum += reported.by_loads.dot(found.multipliers.col(number));
  return sum;
}

}  // namespace

struct Perturbations::Parts {
  const Statics& statics;
  std::vector<physical::Perturbation> perturbations{};
};

Perturbations::Perturbations(const Statics& statics, const std::vector<Perturbed>& perturbed)
    : parts_(std::make_unique<Parts>(Parts{statics})) {
  const physical::Equilibria& equilibria =
      statics.parts_->need_equilibria("derivatives by numbers of the robot are for the physical formulation");
  for (const Perturbed& each : perturbed) {
    if (!(each.difference != 0 && std::isfinite(each.difference)))
      throw InvalidInput("a number is not perturbed, or by a difference that is not finite");
    parts_->perturbations.emplace_back(each, equilibria.system());
  }
}

Perturbations::~Perturbations() = default;
Perturbations::Perturbations(Perturbations&&) noexcept = default;
Perturbations& Perturbations::operator=(Perturbations&&) noexcept = default;

ParameterSensitivity Perturbations::at(const State& at, const StaticsOptions& options, double accuracy,
                                       bool reactions) const {
  Statics::Parts& statics = *parts_->statics.parts_;
  statics.check_known(at, options, "the sensitivity of a shape");
  const TeamPool::Lent team = statics.lender.lend(options);
  return statics.equilibria()->sensitivity(at, parts_->perturbations, statics.options_of(options), accuracy, reactions,
                                           *team);
}

Eigen::MatrixXd Perturbations::gradients(const State& at, const std::vector<ShapeGradient>& reported,
                                         const StaticsOptions& options, double accuracy) const {
  Statics::Parts& statics = *parts_->statics.parts_;
  statics.check_known(at, options, "the sensitivity of a shape");
  for (const ShapeGradient& each : reported) {
    const bool places = each.by_places.rows() == 0 || each.by_places.rows() == at.positions.rows();
    const bool loads = each.by_loads.size() == 0 || each.by_loads.size() == at.multipliers.size();
    if (!places || !loads || !each.by_places.allFinite() || !each.by_loads.allFinite())
      throw InvalidInput(
          "a gradient must be of three finite values for each of the robot's vertices, and of one for "
          "each of its actuators");
  }
  if (statics.equilibria()->system().reciprocal()) {
    const TeamPool::Lent team = statics.lender.lend(options);
    return statics.equilibria()->gradients(at, parts_->perturbations, reported, statics.options_of(options), accuracy,
                                           *team);
  }
  const ParameterSensitivity found = this->at(at, options, accuracy);
  if (!found.regular) return {};
  Eigen::MatrixXd result(reported.size(), found.positions.size());
  for (Index p = 0; p < result.cols(); ++p)
    for (Index r = 0; r < result.rows(); ++r) result(r, p) = change_of(reported[r], found, p);
  return result;
}

}  // namespace softkin
