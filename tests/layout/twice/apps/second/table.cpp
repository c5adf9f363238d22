namespace softkin {

/// As in the first program, which is another one.
struct Table {};

namespace second {

struct Column {};

}  // namespace second

}  // namespace softkin
