#include "dkp_slam/sensor/synthetic/figure.h"

#include <gtest/gtest.h>
