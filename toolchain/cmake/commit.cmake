# Writes the source of firmware/version/commit.h when it has changed:
#
#   cmake -DROOT=FOLDER -DOUTPUT=FILE -P commit.cmake
#
# ROOT must be the root of the repository: sources unpacked inside another repository have no commit. Changed
# documents and tests do not make a program dirty, because they are not part of it.
set(commit unknown)
find_program(GIT git)
if(GIT AND EXISTS ${ROOT}/.git)
  execute_process(COMMAND ${GIT} rev-parse --short=12 HEAD
    WORKING_DIRECTORY ${ROOT} RESULT_VARIABLE no_head OUTPUT_VARIABLE head ERROR_QUIET
    OUTPUT_STRIP_TRAILING_WHITESPACE)
  execute_process(COMMAND ${GIT} status --porcelain -- . :!docs :!tests
    WORKING_DIRECTORY ${ROOT} RESULT_VARIABLE no_status OUTPUT_VARIABLE changes ERROR_QUIET)
  if(no_head EQUAL 0 AND no_status EQUAL 0)
    set(commit ${head})
    if(changes)
      string(APPEND commit -dirty)
    endif()
  endif()
endif()

set(source "#include \"firmware/version/commit.h\"

namespace stilt::version {

std::string_view commit() noexcept { return \"${commit}\"; }

}  // namespace stilt::version
")
if(EXISTS ${OUTPUT})
  file(READ ${OUTPUT} present)
endif()
if(NOT source STREQUAL "${present}")
  file(WRITE ${OUTPUT} "${source}")
endif()
