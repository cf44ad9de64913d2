# GRANULAR_VARIANTS: the library as a shared one, compiled three times. The system's loader takes the best that the processor
# knows (ld.so --help names them): the folder of the library holds the one for any x86-64, folders below it those for AVX2 and
# AVX-512. The bits of all answers are the same.
#
# Programs hold copies of inline functions that they share with the library, compiled for any x86-64: the library must
# call its own.
target_link_options(granular PRIVATE -Wl,-Bsymbolic)
set_target_properties(granular PROPERTIES VISIBILITY_INLINES_HIDDEN ON VERSION ${PROJECT_VERSION} SOVERSION 0)

foreach(level v3 v4)
  set(variant granular_${level})
  add_library(${variant} SHARED $<TARGET_PROPERTY:granular,SOURCES>)
  foreach(property LINK_LIBRARIES INCLUDE_DIRECTORIES COMPILE_DEFINITIONS COMPILE_FEATURES LINK_OPTIONS VISIBILITY_INLINES_HIDDEN
      VERSION SOVERSION)
    get_target_property(value granular ${property})
    if(NOT value MATCHES "-NOTFOUND$")
      set_target_properties(${variant} PROPERTIES ${property} "${value}")
    endif()
  endforeach()
  get_target_property(options granular COMPILE_OPTIONS)
  set_target_properties(${variant} PROPERTIES
    COMPILE_OPTIONS "${options};-march=x86-64-${level}"
    OUTPUT_NAME granular
    LIBRARY_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/glibc-hwcaps/x86-64-${level})
  add_dependencies(granular ${variant})
  install(TARGETS ${variant} LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}/glibc-hwcaps/x86-64-${level} NAMELINK_SKIP)
endforeach()
