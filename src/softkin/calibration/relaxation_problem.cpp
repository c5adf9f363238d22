#include <algorithm>
#include <cmath>
#include <limits>
#include <softkin/calibration/relaxation_problem.hpp>
#include <softkin/core/dense.hpp>
#include <softkin/core/error.hpp>
#include <softkin/core/text.hpp>
#include <softkin/model/names.hpp>

namespace softkin::calibration {

namespace {

using Eigen::VectorXd;

VectorXd vector_of(const std::vector<double>& values) {
  return Eigen::Map<const VectorXd>(values.data(), values.size());
}

bool is_limit(const std::string& constant) {
  return constant == "jm";
}

/// May the constant be below 0? Those that make up the modulus at rest may not.
bool is_signless(const std::string& constant) {
  return constant == "c20" || constant == "c30";
}

double excess_of(double stretch) {
  return stretch * stretch + 2 / stretch - 3;
}

std::string listed(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text;
}

}  // namespace

std::vector<std::string> constant_names(Law law) {
  switch (law) {
    case Law::neo_hookean:
      return {"c10"};
    case Law::mooney_rivlin:
      return {"c10", "c01"};
    case Law::yeoh:
      return {"c10", "c20", "c30"};
    case Law::gent:
      return {"shear_modulus", "jm"};
    case Law::st_venant_kirchhoff:
    case Law::corotational:
    case Law::ogden:
      break;
  }
  throw InvalidInput("relaxation is fitted with neo-hookean, mooney-rivlin, yeoh and gent alone");
}

IncompressibleLaw law_of_constants(Law law, const std::vector<double>& values) {
  IncompressibleLaw result{law, values[0], 0, 0, 0};
  if (law == Law::mooney_rivlin) result.c01 = values[1];
  if (law == Law::yeoh) {
    result.c20 = values[1];
    result.c30 = values[2];
  }
  if (law == Law::gent) {
    result.c10 = values[0] / 2;
    result.jm = values[1];
  }
  return result;
}

History imposed_in(const RelaxationRun& run) {
  return {vector_of(run.time_s), vector_of(run.load_imposed ? run.stress_MPa : run.stretch)};
}

VectorXd answer_in(const RelaxationRun& run) {
  return vector_of(run.load_imposed ? run.stretch : run.stress_MPa);
}

std::optional<VectorXd> answer_of(const MaxwellElement& element, const RelaxationRun& run) {
  const History imposed = imposed_in(run);
  if (run.load_imposed) {
    std::optional<LoadedStretch> found = stretch_under(element, imposed);
    return found ? std::optional(std::move(found->stretch)) : std::nullopt;
  }
  if (element.law.jm > 0)
    for (const double stretch : run.stretch)
      if (excess_of(stretch) >= element.law.jm) return std::nullopt;
  return stress_under(element, imposed);
}

RelaxationProblem::RelaxationProblem(std::vector<RelaxationRun> runs, Law law,
                                     const std::map<std::string, double>& held, std::array<double, 2> times)
    : runs_(std::move(runs)), law_(law), names_(constant_names(law)), held_(names_.size()), times_(times) {
  for (const auto& [name, value] : held) {
    const auto found = std::find(names_.begin(), names_.end(), name);
    if (found == names_.end())
      throw InvalidInput("there is no constant '" + name + "' of " + law_name(law) + ": " + listed(names_));
    held_[found - names_.begin()] = value;
  }
  for (const auto& value : held_) free_constants_ += value ? 0 : 1;
  for (const RelaxationRun& run : runs_) {
    rows_ += run.time_s.size();
    for (const double stretch : run.stretch) max_excess_ = std::max(max_excess_, excess_of(stretch));
  }
  if (law_ == Law::gent && held_[1] && !(*held_[1] > max_excess_))
    throw InvalidInput("jm must be above " + number(max_excess_) + ", which I1 - 3 comes to in the tests, not " +
                       number(*held_[1]));
}

VectorXd RelaxationProblem::unknowns(const std::vector<double>& constants,
                                     const std::vector<ViscousBranch>& branches) const {
  VectorXd all(free_constants_ + 2 * std::ssize(branches));
  Eigen::Index at = 0;
  for (std::size_t c = 0; c < names_.size(); ++c) {
    if (held_[c]) continue;
    all[at++] = is_limit(names_[c]) ? std::log(constants[c] - max_excess_) : constants[c];
  }
  for (const ViscousBranch& branch : branches) {
    all[at++] = branch.modulus_MPa;
    all[at++] = std::log(branch.time_s);
  }
  return all;
}

std::vector<double> RelaxationProblem::constants(const VectorXd& unknowns) const {
  std::vector<double> values;
  Eigen::Index at = 0;
  for (std::size_t c = 0; c < names_.size(); ++c) {
    const double value = held_[c] ? *held_[c] : unknowns[at++];
    values.push_back(!held_[c] && is_limit(names_[c]) ? max_excess_ + std::exp(value) : value);
  }
  return values;
}

MaxwellElement RelaxationProblem::element(const VectorXd& unknowns) const {
  MaxwellElement element{law_of_constants(law_, constants(unknowns)), {}};
  for (Eigen::Index at = free_constants_; at + 1 < unknowns.size(); at += 2)
    element.branches.push_back({unknowns[at], std::exp(unknowns[at + 1])});
  return element;
}

std::array<double, 2> RelaxationProblem::bounds(Eigen::Index unknown) const {
  constexpr double infinite = std::numeric_limits<double>::infinity();
  if (unknown >= free_constants_) {
    if ((unknown - free_constants_) % 2 == 0) return {0, infinite};
    return {std::log(times_[0]), std::log(times_[1])};
  }
  std::size_t constant = 0;
  for (Eigen::Index left = unknown;; ++constant)
    if (!held_[constant] && left-- == 0) break;
  constexpr double nearest = 1e-3, farthest = 1e3;  // of jm above the runs' I1 - 3, over it
  if (is_limit(names_[constant])) return {std::log(nearest * max_excess_), std::log(farthest * max_excess_)};
  return {is_signless(names_[constant]) ? -infinite : 0, infinite};
}

bool RelaxationProblem::is_modulus(Eigen::Index unknown) const {
  if (unknown >= free_constants_) return (unknown - free_constants_) % 2 == 0;
  return !(law_ == Law::gent && !held_[1] && unknown == free_constants_ - 1);
}

double RelaxationProblem::slope(const VectorXd& unknowns, Eigen::Index unknown) const {
  return is_modulus(unknown) ? 1 : std::exp(unknowns[unknown]);
}

std::optional<VectorXd> RelaxationProblem::residuals(const VectorXd& unknowns) const {
  const MaxwellElement tried = element(unknowns);
  VectorXd all(rows_);
  Eigen::Index at = 0;
  for (const RelaxationRun& run : runs_) {
    const std::optional<VectorXd> answer = answer_of(tried, run);
    if (!answer || !answer->allFinite()) return std::nullopt;
    all.segment(at, answer->size()) = (*answer - answer_in(run)) / scale(run.load_imposed);
    at += answer->size();
  }
  return all;
}

VectorXd RelaxationProblem::law_stress(const RelaxationRun& run, const std::vector<double>& constants) const {
  const IncompressibleLaw law = law_of_constants(law_, constants);
  VectorXd stress(run.stretch.size());
  for (Eigen::Index i = 0; i < stress.size(); ++i) stress[i] = uniaxial_stress(law, run.stretch[i] - 1);
  return stress;
}

/// By the constants that are not held.
VectorXd RelaxationProblem::law_slopes(const VectorXd& unknowns, double stretch) const {
  VectorXd slopes(free_constants_);
  for (Eigen::Index c = 0; c < free_constants_; ++c) {
    const double step = is_modulus(c) ? 1 : 1e-5;  // of what is linear any step will do
    VectorXd up = unknowns, down = unknowns;
    up[c] += step;
    down[c] -= step;
    slopes[c] = (uniaxial_stress(law_of_constants(law_, constants(up)), stretch - 1) -
                 uniaxial_stress(law_of_constants(law_, constants(down)), stretch - 1)) /
                (2 * step);
  }
  return slopes;
}

bool RelaxationProblem::tells_constants(const std::vector<double>& constants) const {
  constexpr double least = 1e-5;  // square of what is left of a column beside the others, over the column
  const VectorXd start = unknowns(constants, {});
  Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(free_constants_, free_constants_);
  for (const RelaxationRun& run : runs_)
    for (const double stretch : run.stretch) {
      const VectorXd slopes = law_slopes(start, stretch);
      normal += slopes * slopes.transpose();
    }
  if (free_constants_ == 0) return true;
  const VectorXd scale = normal.diagonal().cwiseSqrt().cwiseInverse();
  return scale.allFinite() &&
         symmetric_eigenvalues(scale.asDiagonal() * normal * scale.asDiagonal()).minCoeff() > least;
}

void RelaxationProblem::fill_stress_slopes(const RelaxationRun& run, const VectorXd& unknowns, Part part) const {
  for (Eigen::Index i = 0; i < part.rows(); ++i)
    part.row(i).head(free_constants_) = law_slopes(unknowns, run.stretch[i]).transpose();
  const std::vector<ViscousBranch> branches = element(unknowns).branches;
  for (std::size_t b = 0; b < branches.size(); ++b) {
    const UnitBranch unit = unit_branch(imposed_in(run), branches[b].time_s);
    const Eigen::Index first = free_constants_ + 2 * b;
    part.col(first) = unit.stress;
    part.col(first + 1) = branches[b].modulus_MPa * unit.by_log_time;
  }
}

void RelaxationProblem::fill_stretch_slopes(const RelaxationRun& run, const VectorXd& unknowns, Part part) const {
  const auto of_law = [&](double stretch) { return law_slopes(unknowns, stretch); };
  part = stretch_under(element(unknowns), imposed_in(run), of_law).value().slopes;  // it had residuals
}

Eigen::MatrixXd RelaxationProblem::slopes(const VectorXd& unknowns) const {
  Eigen::MatrixXd all(rows_, unknowns.size());
  Eigen::Index at = 0;
  for (const RelaxationRun& run : runs_) {
    Part part = all.middleRows(at, run.time_s.size());
    run.load_imposed ? fill_stretch_slopes(run, unknowns, part) : fill_stress_slopes(run, unknowns, part);
    part /= scale(run.load_imposed);
    at += part.rows();
  }
  return all;
}

RelaxationProblem::Linear RelaxationProblem::linear(const std::vector<double>& constants) const {
  Linear linear;
  for (const bool signless : {true, false})
    for (std::size_t c = 0; c < names_.size(); ++c)
      if (!held_[c] && !is_limit(names_[c]) && is_signless(names_[c]) == signless) linear.constants.push_back(c);
  for (const std::size_t c : linear.constants) linear.signless += is_signless(names_[c]) ? 1 : 0;
  linear.columns.resize(rows_, linear.constants.size());
  linear.right.resize(rows_);
  std::vector<double> rest = constants;
  for (const std::size_t c : linear.constants) rest[c] = 0;
  Eigen::Index at = 0;
  for (const RelaxationRun& run : runs_) {
    const Eigen::Index size = run.time_s.size();
    linear.right.segment(at, size) = (vector_of(run.stress_MPa) - law_stress(run, rest)) / scale(false);
    for (std::size_t k = 0; k < linear.constants.size(); ++k) {
      std::vector<double> unit = rest;
      unit[linear.constants[k]] = 1;
      linear.columns.col(k).segment(at, size) = (law_stress(run, unit) - law_stress(run, rest)) / scale(false);
    }
    at += size;
  }
  return linear;
}

VectorXd RelaxationProblem::column(double time_s) const {
  constexpr double enough = 1e-6;
  VectorXd all(rows_);
  Eigen::Index at = 0;
  for (const RelaxationRun& run : runs_) {
    const VectorXd stress = unit_branch({vector_of(run.time_s), vector_of(run.stretch)}, time_s, enough).stress;
    all.segment(at, stress.size()) = stress / scale(false);
    at += stress.size();
  }
  return all;
}

}  // namespace softkin::calibration
