// Nothing: a target has a source, and this one's headers are all that is wanted of it
// (cmake/DkpSlamTargets.cmake).
