#include <cmath>
#include <softkin/model/compile/parts.hpp>

namespace softkin {

namespace {

struct Constants {
  const ElasticSpec& spec;
  const std::string& owner;
  const Origin& origin;

  [[noreturn]] void refuse(const std::string& what) const { throw InvalidInput(origin, owner + what); }

  double required(const std::optional<double>& value, const std::string& name) const {
    if (!value) refuse(" needs " + name + ": its law takes it");
    return finite(*value, name);
  }
  double optional(const std::optional<double>& value, const std::string& name) const {
    return value ? finite(*value, name) : 0;
  }
  double finite(double value, const std::string& name) const {
    if (!std::isfinite(value)) refuse(": " + name + " must be finite, not " + number_text(value));
    return value;
  }
  double positive(double value, const std::string& name) const {
    if (!(value > 0)) refuse(": " + name + " must be above 0, not " + number_text(value));
    return value;
  }
  double poisson_ratio() const {
    const double nu = required(spec.poisson_ratio, "poisson_ratio");
    if (!(nu > -1 && nu < 0.5)) refuse(": poisson_ratio must lie between -1 and 0.5, not be " + number_text(nu));
    return nu;
  }
  void absent(const std::optional<double>& value, const std::string& name) const {
    if (value) refuse(" has " + name + ", which its law does not take");
  }
};

double bulk_modulus(const Constants& c, double shear) {
  if (c.spec.bulk_modulus && c.spec.poisson_ratio)
    c.refuse(" has bulk_modulus and poisson_ratio: it needs one of the two");
  if (c.spec.bulk_modulus) return c.positive(c.required(c.spec.bulk_modulus, "bulk_modulus"), "bulk_modulus");
  if (!c.spec.poisson_ratio) c.refuse(" needs bulk_modulus or poisson_ratio");
  const double nu = c.poisson_ratio();
  return c.finite(2 * shear * (1 + nu) / (3 * (1 - 2 * nu)), "bulk modulus");
}

void set_lame(const Constants& c, ElasticLaw& law) {
  c.absent(c.spec.c10, "c10");
  c.absent(c.spec.c01, "c01");
  c.absent(c.spec.c20, "c20");
  c.absent(c.spec.c30, "c30");
  c.absent(c.spec.bulk_modulus, "bulk_modulus");
  const double e = c.positive(c.required(c.spec.youngs_modulus, "youngs_modulus"), "youngs_modulus");
  const double nu = c.poisson_ratio();
  law.mu = c.finite(e / (2 * (1 + nu)), "shear modulus");
  law.lambda = c.finite(e * nu / ((1 + nu) * (1 - 2 * nu)), "lambda");
}

void set_coefficients(const Constants& c, ElasticLaw& law) {
  c.absent(c.spec.youngs_modulus, "youngs_modulus");
  law.c10 = c.required(c.spec.c10, "c10");
  if (law.law == Law::mooney_rivlin) {
    law.c01 = c.required(c.spec.c01, "c01");
    c.absent(c.spec.c20, "c20");
    c.absent(c.spec.c30, "c30");
  } else {
    c.absent(c.spec.c01, "c01");
    law.c20 = c.optional(c.spec.c20, "c20");
    law.c30 = c.optional(c.spec.c30, "c30");
  }
  const std::string sum = law.law == Law::yeoh ? "c10" : "c10 + c01";
  const double half_shear = c.positive(c.finite(law.c10 + law.c01, sum), sum);
  law.bulk = bulk_modulus(c, 2 * half_shear);
}

}  // namespace

ElasticLaw elastic_law(const ElasticSpec& spec, const std::string& owner, const Origin& origin) {
  const Constants constants{spec, owner, origin};
  ElasticLaw law;
  law.law = spec.law;
  if (spec.law == Law::mooney_rivlin || spec.law == Law::yeoh)
    set_coefficients(constants, law);
  else
    set_lame(constants, law);
  return law;
}

}  // namespace softkin
