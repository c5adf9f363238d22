// The kernel's own header has rates that <termios.h> has not, and cannot stand beside it.
#include <asm/termbits.h>
#include <sys/ioctl.h>

#include <softkin/drive/serial_baud.hpp>

namespace softkin::drive {

bool set_baud(int file, int baud) {
  termios2 settings = {};
  if (ioctl(file, TCGETS2, &settings) != 0) return false;
  settings.c_cflag &= ~static_cast<tcflag_t>(CBAUD);
  settings.c_cflag |= BOTHER;
  settings.c_ispeed = settings.c_ospeed = static_cast<speed_t>(baud);
  return ioctl(file, TCSETS2, &settings) == 0;
}

}  // namespace softkin::drive
