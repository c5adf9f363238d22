#include <softkin/io/scene/parts.hpp>
#include <softkin/model/families.hpp>

namespace softkin::scene {

namespace {

FamilySpec read_family(const Context& context, const Node& node) {
  const Map map(node, {"k1", "k2", "dispersion", "direction"});
  FamilySpec family;
  family.k1_MPa = positive(map.at("k1"));
  family.k2 = not_negative(map.at("k2"));
  family.direction = read_direction(context, map.at("direction"));
  const Node* dispersion = map.find("dispersion");
  if (dispersion == nullptr) return family;
  family.dispersion = not_negative(*dispersion);
  if (family.dispersion > 1.0 / 3)
    fail(*dispersion, dispersion->name + " must be from 0 to 1/3 (in all directions), not " + dispersion->text);
  return family;
}

}  // namespace

std::shared_ptr<const FamiliesSpec> read_families(const Context& context, const Map& material) {
  const Node* node = material.find("families");
  if (node == nullptr) return nullptr;
  FamiliesSpec families;
  for (const auto& item : list(*node)) families.families.push_back(read_family(context, *item));
  if (families.families.empty()) fail(*node, node->name + " is empty");
  return std::make_shared<const FamiliesSpec>(std::move(families));
}

}  // namespace softkin::scene
