// Sample rate and step are independent of each other.

#include <gtest/gtest.h>
