#include <cstdint>

#include "tests/fuzz/parsers.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return raymeter::fuzz("config", {reinterpret_cast<const char*>(data), size});
}
