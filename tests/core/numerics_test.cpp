// The choice of the step: accuracy asked for is accuracy met, in bounded time.

#include <gtest/gtest.h>
