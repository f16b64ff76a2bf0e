#pragma once
// The one place through which a program's words go to its terminal: whatever is printed to stdout
// and stderr, through stdio or streams and also by libraries, is made printable
// (platform/base/printable.h), so that names and texts from files, sockets and arguments cannot
// steer the terminal. Line feeds and tabs stay.

#include <string_view>

namespace zenith {

// For main(), before anything is printed or opened and before other threads start. What goes past
// stdio and streams (write(), child processes) stays as it is.
//
// Of standard input, output and error it takes the numbers of those that are closed, lest a file or
// socket gets one of them and what is printed goes there. Reading and writing fail as before.
void make_output_printable();

// Bytes for the terminal at standard error as they are: our own words that move the cursor.
void write_to_terminal(std::string_view bytes);

}  // namespace zenith
