#include <softkin/model/contact_model.hpp>

namespace softkin {

std::string ContactModel::label(Index part) const {
  const ContactPart& of = parts[part];
  if (of.name == robot_part_name) return "the robot";
  const char* kinds[] = {of.robot == part ? "robot" : "region", "body", "obstacle"};
  return std::string(kinds[static_cast<std::size_t>(of.rank)]) + " '" + of.name + "'";
}

std::string ContactModel::label_of_solid(Index part) const {
  const ContactPart& of = parts[part];
  return label(of.rank == ContactRank::robot ? of.robot : part);
}

}  // namespace softkin
