# Libraries that hertzline::core is linked with; included by the project itself, which sets HERTZLINE_FIND to REQUIRED, and by
# find_package(hertzline).
find_package(Eigen3 3.4 ${HERTZLINE_FIND} NO_MODULE)
find_package(tl-expected ${HERTZLINE_FIND})
find_package(nlohmann_json 3.11 ${HERTZLINE_FIND})
set(HERTZLINE_PACKAGES Eigen3 tl-expected nlohmann_json)
