#include <algorithm>
#include <softkin/core/text.hpp>
#include <softkin/io/scene/parts.hpp>
#include <softkin/io/scene/silicones.hpp>
#include <softkin/model/names.hpp>

namespace softkin::scene {

namespace {

/// The constants that a law takes.
struct LawKeys {
  Law law;
  Keys required, optional;
  bool needs_bulk = false;  // exactly one of bulk_modulus and poisson_ratio
};

/// "mu1"
std::string term_key(const char* key, int term) {
  return key + std::to_string(term + 1);
}

LawKeys keys_of(Law law) {
  const Keys moduli{"youngs_modulus", "poisson_ratio"}, bulk{"bulk_modulus", "poisson_ratio"};
  switch (law) {
    case Law::st_venant_kirchhoff:
    case Law::corotational:
    case Law::neo_hookean:
      return {law, moduli, {}};
    case Law::mooney_rivlin:
      return {law, {"c10"}, {"c01", bulk[0], bulk[1]}, true};
    case Law::yeoh:
      return {law, {"c10"}, {"c20", "c30", bulk[0], bulk[1]}, true};
    case Law::gent:
      return {law, {"shear_modulus", "jm"}, bulk, true};
    case Law::ogden: {
      Keys further;
      for (int term = 1; term < max_ogden_terms; ++term)
        further.insert(further.end(), {term_key("mu", term), term_key("alpha", term)});
      further.insert(further.end(), bulk.begin(), bulk.end());
      return {law, {"mu1", "alpha1"}, further, true};
    }
  }
  return {law, moduli, {}};
}

const std::vector<LawKeys>& laws() {
  static const std::vector<LawKeys> all = [] {
    std::vector<LawKeys> keys;
    for (const Law law : all_laws) keys.push_back(keys_of(law));
    return keys;
  }();
  return all;
}

const Keys& law_names() {
  static const Keys names = [] {
    Keys all;
    for (const Law law : all_laws) all.push_back(law_name(law));
    return all;
  }();
  return names;
}

/// Every key that a law takes, and `law` itself.
const Keys& elastic_keys() {
  static const Keys keys = [] {
    Keys all{"law"};
    for (const LawKeys& law : laws())
      for (const Keys* some : {&law.required, &law.optional})
        for (const std::string& key : *some)
          if (std::find(all.begin(), all.end(), key) == all.end()) all.push_back(key);
    return all;
  }();
  return keys;
}

bool holds(const Keys& keys, const std::string& key) {
  return std::find(keys.begin(), keys.end(), key) != keys.end();
}

const LawKeys& read_law(const Map& map) {
  if (const Node* node = map.find("law")) return laws()[choice(*node, law_names())];
  return *std::find_if(laws().begin(), laws().end(), [](const LawKeys& law) { return law.law == ElasticSpec().law; });
}

/// Fails where a constant is there that the law does not take, or one is missing that it needs.
void check_constants(const Map& map, const LawKeys& law) {
  const std::string name = std::string("law '") + law_name(law.law) + "'" + (map.find("law") ? "" : " (the default)");
  for (const std::string& key : elastic_keys()) {
    const Node::Entry* entry = map.entry(key);
    if (entry && key != "law" && !holds(law.required, key) && !holds(law.optional, key))
      throw InvalidInput(entry->origin, "key '" + key + "' does not belong to " + name + ", which takes " +
                                            joined(law.required) + (law.optional.empty() ? "" : ", ") +
                                            joined(law.optional));
  }
  for (const std::string& key : law.required)
    if (!map.find(key)) fail(map.node(), map.node().name + ": " + name + " needs key '" + key + "'");
  if (law.needs_bulk) (void)map.one_of({"bulk_modulus", "poisson_ratio"});
}

double read_poisson_ratio(const Node& node, Law law) {
  const double ratio = number(node);
  if (ratio == 0.5 && !has_bulk_part(law))
    fail(node, node.name + " is 0.5, which keeps the volume: take 'law: " + laws_with_bulk_part("'").substr(1) +
                   ", which have a part for that, or 0.49");
  if (!(ratio > -1 && ratio <= 0.5))
    fail(node, node.name + " must be greater than -1 and at most 0.5, not " + node.text);
  return ratio;
}

/// The coefficient; 0 where the law takes it and it is absent.
std::optional<double> read_coefficient(const Map& map, const LawKeys& law, const std::string& key) {
  if (!holds(law.required, key) && !holds(law.optional, key)) return std::nullopt;
  const Node* node = map.find(key);
  return node ? number(*node) : 0;
}

/// The constants of a silicone by its name, and which they are.
void read_named(const Map& map, const Silicone& silicone, MaterialSpec& material) {
  for (const std::string& key : elastic_keys())
    if (const Node::Entry* entry = map.entry(key); entry && key != "poisson_ratio")
      throw InvalidInput(entry->origin, "key '" + key + "' does not go with 'material', which has the constants of " +
                                            silicone.name +
                                            ": 'set', 'poisson_ratio' and 'density' may stand beside it");
  const Node* ratio = map.find("poisson_ratio");
  const double nu = ratio ? read_poisson_ratio(*ratio, Law::neo_hookean) : Silicone::usual_poisson_ratio;
  const Node* set = map.find("set");
  const std::string name = set ? text(*set) : Silicone::default_set;
  material.elastic = silicone.elastic(name, nu, set ? set->origin : map.node().origin);
  material.named = std::make_shared<const NamedMaterial>(silicone.named(name, nu));
  material.density = silicone.density;
}

/// Ogden's terms: the first one, and those that have a strength or an exponent.
std::vector<OgdenTerm> read_terms(const Map& map) {
  std::vector<OgdenTerm> terms;
  double twice_shear = 0;
  for (int term = 0; term < max_ogden_terms; ++term) {
    const std::string mu = term_key("mu", term), alpha = term_key("alpha", term);
    if (!map.find(mu) && !map.find(alpha)) continue;
    if (!map.find(mu) || !map.find(alpha))
      fail(map.node(), map.node().name + ": law 'ogden' needs '" + mu + "' and '" + alpha + "' together");
    terms.push_back({number(map.at(mu)), number(map.at(alpha))});
    if (terms.back().alpha == 0) fail(map.at(alpha), "'" + alpha + "' must not be 0: such a term stores no energy");
    twice_shear += terms.back().mu * terms.back().alpha;
  }
  if (!(twice_shear > 0))
    fail(map.at("mu1"),
         "the shear modulus at small strain, half the sum of 'mu' times 'alpha' of every term, must be greater than 0, "
         "not " +
             softkin::number(twice_shear / 2) + " MPa");
  return terms;
}

std::optional<ElasticSpec> read_elastic(const Map& map) {
  if (std::none_of(elastic_keys().begin(), elastic_keys().end(),
                   [&](const std::string& key) { return map.entry(key); }))
    return std::nullopt;
  const LawKeys& law = read_law(map);
  check_constants(map, law);
  ElasticSpec elastic;
  elastic.law = law.law;
  if (const Node* node = map.find("youngs_modulus")) elastic.youngs_modulus = positive(*node);
  if (const Node* node = map.find("poisson_ratio")) elastic.poisson_ratio = read_poisson_ratio(*node, law.law);
  if (const Node* node = map.find("bulk_modulus")) elastic.bulk_modulus = positive(*node);
  if (const Node* node = map.find("shear_modulus")) elastic.shear_modulus = positive(*node);
  if (const Node* node = map.find("jm")) elastic.jm = positive(*node);
  if (law.law == Law::ogden) elastic.ogden = read_terms(map);
  elastic.c10 = read_coefficient(map, law, "c10");
  elastic.c01 = read_coefficient(map, law, "c01");
  elastic.c20 = read_coefficient(map, law, "c20");
  elastic.c30 = read_coefficient(map, law, "c30");
  // the shear modulus at small strain is twice this sum
  if (elastic.c10 && !(*elastic.c10 + elastic.c01.value_or(0) > 0))
    fail(map.at("c10"), std::string(elastic.c01 ? "'c10' + 'c01'" : "'c10'") + " must be greater than 0");
  return elastic;
}

std::optional<double> read_shape_ratio(const Map& map) {
  const Node* node = map.find("shape_ratio");
  if (!node) return std::nullopt;
  const double ratio = number(*node);
  if (ratio < 0 || ratio > 1) fail(*node, "'shape_ratio' must be from 0 to 1, not " + node->text);
  return ratio;
}

/// Maxwell branches.
std::vector<ViscousBranch> read_viscosity(const Node& node) {
  std::vector<ViscousBranch> branches;
  for (const auto& item : list(node)) {
    const Map map(*item, {"modulus", "time"});
    branches.push_back({positive(map.at("modulus")), positive(map.at("time"))});
  }
  return branches;
}

double read_permittivity(const Node& node) {
  const double permittivity = number(node);
  if (!(permittivity >= 1))
    fail(node, node.name + " is over that of the vacuum and must be 1 or more, not " + node.text);
  return permittivity;
}

}  // namespace

double read_density(const Node& node) {
  const double density = number(node);
  if (density < 0) fail(node, node.name + " must not be negative: " + node.text);
  return density;
}

MaterialSpec read_material(const Context& context, const Node& node) {
  Keys known{"region",    "shape_ratio",   "weight",   "linear_range", "density",  "viscosity", "permittivity",
             "remanence", "magnetisation", "material", "elements",     "families", "set"};
  known.insert(known.end(), elastic_keys().begin(), elastic_keys().end());
  check_choice(node, "law", law_names());
  const Map map(node, known);
  MaterialSpec material;
  material.origin = node.origin;
  const Node* region = map.find("region");
  material.region = region ? text(*region) : "all";
  material.shape_ratio = read_shape_ratio(map);
  const Node* name = map.find("material");
  if (const Node* set = map.find("set"); set && !name)
    fail(*set, set->name + " goes with 'material', whose constants it chooses");
  if (name)
    read_named(map, silicone(text(*name), name->origin), material);
  else
    material.elastic = read_elastic(map);
  if (!material.shape_ratio && !material.elastic)
    fail(node, node.name +
                   " needs 'shape_ratio' (target-shape) or elastic constants (physical), such as 'youngs_modulus' and "
                   "'poisson_ratio', or 'material: ecoflex-00-30'");
  if (const Node* weight = map.find("weight")) material.weight = positive(*weight);
  if (const Node* density = map.find("density")) material.density = read_density(*density);
  if (const Node* viscosity = map.find("viscosity")) material.viscosity = read_viscosity(*viscosity);
  if (const Node* value = map.find("permittivity")) material.permittivity = read_permittivity(*value);
  material.remanence = read_remanence(context, map);
  material.families = read_families(context, map);
  if (const Node* range = map.find("linear_range")) material.linear_range = positive(*range);
  if (const Node* elements = map.find("elements")) material.mixed = choice(*elements, {"plain", "mixed"}) == 1;
  return material;
}

}  // namespace softkin::scene
