// Bursts of every shape, again and again: the integration follows the horn's breaks.

#include <gtest/gtest.h>
