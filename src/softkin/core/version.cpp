#include <softkin/core/version.hpp>

namespace softkin {

const char* version() {
  return SOFTKIN_VERSION;
}

}  // namespace softkin
