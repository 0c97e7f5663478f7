# Libraries that hertzline::core is linked with; included by the project itself and by find_package(hertzline).
find_package(Eigen3 3.4 REQUIRED NO_MODULE)
find_package(tl-expected REQUIRED)
find_package(nlohmann_json 3.11 REQUIRED)
