#pragma once

#include <exception>
#include <string>

namespace dkp_slam::apps {

/// This very program's file, to start it once more, also when a newer build has taken its name
/// meanwhile.
inline constexpr const char* this_program = "/proc/self/exe";

/// To be called first: makes the program independent of how it was started. Descriptors 0 to 2 that
/// are closed lead nowhere (a file opened later would get their numbers, and messages with them),
/// and a reader that goes away or a limit on the size of files ends writing, not the program. Where
/// memory runs out in a library that then cannot go on, the program ends with code 1 and a line.
/// All threads take memory from two arenas: one for each keeps what another could use.
void prepare_process();

/// What to tell of an exception, in one line: of memory that ran out, what that means.
std::string message_of(const std::exception& error);

/// `text` with control characters but the line break shown as '?': file names and values of inputs
/// stand in messages, and a terminal obeys what they hold.
std::string printable(std::string text);
/// The same with line breaks shown as '?', too.
std::string one_line(std::string text);

/// Messages of the program and its libraries go to stderr in this form, whatever names they hold.
void log_to_stderr();

}  // namespace dkp_slam::apps
