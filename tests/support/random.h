#pragma once

#include "experiments/cases/random.h"

namespace raymeter::test {

using cases::Random;

}  // namespace raymeter::test
