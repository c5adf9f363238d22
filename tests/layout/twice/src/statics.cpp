namespace {

struct Pose {};  // nobody else's

}  // namespace

namespace softkin {

class Pose {
  struct Row {};
};

class Column;

enum class inner::Kind : int { pneumatic };

void solve() {
  struct Column {};
}

}  // namespace softkin
