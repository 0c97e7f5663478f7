#pragma once
// Everything, for programs that link hertzline::hertzline. Those that link hertzline::core alone include simulation.hpp and resolve.hpp.

#include "hertzline/drive_record.hpp"
#include "hertzline/integrator.hpp"
#include "hertzline/ledger.hpp"
#include "hertzline/materials.hpp"
#include "hertzline/resolve.hpp"
#include "hertzline/run.hpp"
#include "hertzline/samples.hpp"
#include "hertzline/scene.hpp"
#include "hertzline/scene_file.hpp"
#include "hertzline/simulation.hpp"
#include "hertzline/spectrum.hpp"
#include "hertzline/stream.hpp"
#include "hertzline/studies.hpp"
#include "hertzline/taps.hpp"
