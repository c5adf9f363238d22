namespace softkin {

/// As in the library.
struct Row {};

/// As in the second program, which is another one.
struct Table {};

}  // namespace softkin
