#include "firmware/commissioning/formatted.h"

#include <cstdarg>
#include <cstdio>

namespace stilt::commissioning {

std::string formatted(const char* format, ...) {
  char buffer[400];
  std::va_list arguments;
  va_start(arguments, format);
  std::vsnprintf(buffer, sizeof buffer, format, arguments);
  va_end(arguments);
  return buffer;
}

}  // namespace stilt::commissioning
