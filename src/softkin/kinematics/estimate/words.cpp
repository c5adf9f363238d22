#include <charconv>
#include <cmath>
#include <softkin/core/error.hpp>
#include <softkin/core/text.hpp>
#include <softkin/kinematics/estimator.hpp>

namespace softkin {

namespace {

/// The readings hardly determine a number where its standard deviation is above this fraction of the prior one.
constexpr double hardly = 0.5;
/// Misfit above which readings do not fit the model, in standard deviations.
constexpr double doubtful = 3;

/// Returns the value with its unit, if it has one.
std::string in_its_unit(double value, int digits, const EstimatedNumber& of) {
  return number(value, digits) + (of.unit.empty() ? "" : " " + of.unit);
}

std::string listed(const std::vector<std::string>& names) {
  std::string text;
  for (std::size_t i = 0; i < names.size(); ++i)
    text += (i == 0 ? "" : i + 1 < names.size() ? ", " : " and ") + names[i];
  return text;
}

}  // namespace

std::vector<std::string> estimate_words(const Estimate& estimate, const std::vector<ReadingGroup>& groups) {
  std::vector<std::string> words;
  for (const EstimatedNumber& estimated : estimate.numbers) {
    if (estimated.deviation > hardly * estimated.known_deviation)
      words.push_back(estimated.name + " is known to " + in_its_unit(estimated.deviation, 2, estimated) +
                      " only: the readings hardly say more than what was known before, " +
                      number(estimated.known_mean, 3) + " +- " + in_its_unit(estimated.known_deviation, 3, estimated));
    if (estimated.at_bound != 0)
      words.push_back(estimated.name + " is at the " + (estimated.at_bound < 0 ? "low" : "high") +
                      " end of its range: the readings may want more");
  }
  for (const EstimatedPlace& place : estimate.places)
    if (const double deviation = std::sqrt(place.covariance.trace()), known = std::sqrt(place.known_covariance.trace());
        deviation > hardly * known)
      words.push_back("the place of " + place.force + " is known to " + number(deviation, 2) +
                      " mm only: anywhere on its region is " + number(known, 2) + " mm");
  if (!estimate.left_out.empty()) {
    std::vector<std::string> names;
    for (const std::size_t g : estimate.left_out) names.push_back(groups[g].name);
    words.push_back("left out, as it contradicts the other readings: " + listed(names));
  }
  if (const double misfit = estimate.misfit(); misfit > doubtful)
    words.push_back("the readings do not fit the model: their chi-square, " + number(estimate.chi_square, 3) + " for " +
                    number(estimate.freedoms, 3) + " freedoms, is " + number(misfit, 2) +
                    " standard deviations too large. A reading, a deviation or the model is wrong");
  return words;
}

EstimatedUnknown parse_unknown(const std::string& option, const std::string& text) {
  const auto refuse = [&](const std::string& why) { throw InvalidInput(option + " '" + text + "': " + why); };
  EstimatedUnknown unknown;
  unknown.option = option;
  const std::size_t equals = text.find('=');
  unknown.name = text.substr(0, equals);
  if (const std::size_t colon = unknown.name.find(':'); colon != std::string::npos) {
    if (unknown.name.substr(colon) != ":place") refuse("what comes after the colon can only be 'place'");
    unknown.somewhere = true;
    unknown.name.resize(colon);
  }
  if (unknown.name.empty()) refuse("expected NAME, NAME:place or one of them with =MEAN+-DEVIATION");
  if (equals == std::string::npos) return unknown;
  const std::string known = text.substr(equals + 1);
  const std::size_t sign = known.find("+-");
  const auto value = [&](const std::string& part) {
    double read = 0;
    const auto [end, error] = std::from_chars(part.data(), part.data() + part.size(), read);
    if (error != std::errc() || end != part.data() + part.size() || !std::isfinite(read))
      refuse("expected MEAN+-DEVIATION after '='");
    return read;
  };
  if (sign == std::string::npos) refuse("expected MEAN+-DEVIATION after '='");
  unknown.mean = value(known.substr(0, sign));
  unknown.deviation = value(known.substr(sign + 2));
  if (!(*unknown.deviation > 0)) refuse("the deviation must be above 0");
  return unknown;
}

}  // namespace softkin
