# hertzline_loads(SOURCE MACRO LIBRARY): SOURCE loads LIBRARY when it is needed, and MACRO is the name under which the system has it.
function(hertzline_loads source macro library)
  execute_process(COMMAND ${CMAKE_READELF} --dynamic --wide ${library} OUTPUT_VARIABLE dynamic COMMAND_ERROR_IS_FATAL ANY)
  string(REGEX MATCH "SONAME[^[]*\\[([^]]+)" soname "${dynamic}")
  set_property(SOURCE ${source} APPEND PROPERTY COMPILE_DEFINITIONS "${macro}=\"${CMAKE_MATCH_1}\"")
endfunction()
