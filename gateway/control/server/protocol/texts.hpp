// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "firmware_if/text/finding.hpp"

/// Sentences of the control socket: what it refuses by itself (the gate has its own), and what it says when
/// something was accepted.
namespace servogate::gateway::says {

// refusals; ids begin with "socket."
extern const text::Entry kBadLine;       ///< {0} the line
extern const text::Entry kNoObject;      ///< {0} what stands there
extern const text::Entry kNested;        ///< {0} levels
extern const text::Entry kRepeated;      ///< field {0}
extern const text::Entry kWrongType;     ///< {0} key, {1} what it must be, {2} what stands there
extern const text::Entry kLongLine;      ///< {0} bytes
extern const text::Entry kFull;          ///< {0} clients
extern const text::Entry kUnknown;       ///< {0} command
extern const text::Entry kUnknownAsker;  ///< {0} asker, {1} known ones
extern const text::Entry kNoAxis;        ///< {0} axis, {1} axes of the machine
extern const text::Entry kNotUnit;       ///< {0} unit, {1} axis, {2} its unit
extern const text::Entry kNoNumber;      ///< {0} key
extern const text::Entry kNotProcess;    ///< {0} the largest possible
extern const text::Entry kNotTable;      ///< {0} what was said
extern const text::Entry kRowRange;      ///< {0} origin or tool, {1} lowest, {2} highest
extern const text::Entry kRowMissing;    ///< {0} origin or tool, {1} number, {2} those that are there
extern const text::Entry kEntryUnknown;  ///< {0} name, {1} of what, {2} possible ones
extern const text::Entry kEntryRange;    ///< {0} name, {1} value, {2} lowest, {3} highest
extern const text::Entry kEntryHere;     ///< {0} name
extern const text::Entry kNothingGiven;
extern const text::Entry kNoUndo;
extern const text::Entry kNotImported;       ///< {0} file
extern const text::Entry kNotSwitch;         ///< {0} key
extern const text::Entry kNoAnswer;          ///< the cycle stands
extern const text::Entry kWithdrawn;         ///< the same, and the request was withdrawn
extern const text::Entry kLeftToCycle;       ///< the same, and the request was not
extern const text::Entry kOvertaken;         ///< a stop came behind the request
extern const text::Entry kEnding;            ///< nothing is begun any more
extern const text::Entry kComesOn;           ///< the drives are about to be ready
extern const text::Entry kNotReadable;       ///< {0} program, {1} why
extern const text::Entry kNotLoaded;         ///< {0} program
extern const text::Entry kNotStarted;        ///< {0} program
extern const text::Entry kMoreFindings;      ///< {0} how many
extern const text::Entry kBlockWrong;        ///< {0} what is wrong
extern const text::Entry kBlocksSeveral;     ///< more than one line typed
extern const text::Entry kNoDistance;        ///< a jog by 0
extern const text::Entry kBlockEmpty;        ///< nothing typed
extern const text::Entry kNoJog;             ///< keep-alive without a jog
extern const text::Entry kNoSuchObject;      ///< sdo_read: no such bus, or no object
extern const text::Entry kForeignNode;       ///< {0} node, {1} nodes of the bus
extern const text::Entry kOnlyRead;          ///< {0} command; of a `servogate run`
extern const text::Entry kObjectUnanswered;  ///< sdo_read: the node does not run, or somebody else reads
extern const text::Entry kNotSaved;          ///< {0} the system's words

// accepted
extern const text::Entry kPowerOn, kPowerOff;
extern const text::Entry kHomingAll;
extern const text::Entry kHoming;       ///< {0} axes
extern const text::Entry kJog;          ///< {0} axis, {1} distance, {2} unit
extern const text::Entry kJogDiameter;  ///< {0} axis, {1} diameter, {2} radius
extern const text::Entry kJogClipped;   ///< {0} axis, {1} limit, {2} unit
extern const text::Entry kJogs;         ///< {0} axis, {1} direction
extern const text::Entry kZero;         ///< {0} axis, {1} value, {2} unit, {3} origin, {4} machine coordinate
extern const text::Entry kZeroDiameter;  ///< as kZero
extern const text::Entry kBlockRuns;
extern const text::Entry kRowSet;      ///< {0} origin or tool, {1} number, {2} its values
extern const text::Entry kRowCleared;  ///< {0}, {1} as before
extern const text::Entry kTablesUndone;
extern const text::Entry kImported;     ///< {0} file, {1} rows
extern const text::Entry kAssigned;     ///< {0} axis, {1} process
extern const text::Entry kLoaded;       ///< {0} program, {1} blocks, {2} warnings
extern const text::Entry kStarted;      ///< {0} program
extern const text::Entry kTypedGoesOn;  ///< {0} block
extern const text::Entry kStepped, kHeld, kManualStopped, kNothingHeld, kResumed, kStopped, kJogsStopped,
    kNothingJogged, kJogStopped, kNotJogged;
extern const text::Entry kPlaceSet;  ///< {0} has the value {1}
extern const text::Entry kNoPlace;   ///< {0} is none
extern const text::Entry kReset;
extern const text::Entry kResetLeft;  ///< {0} alarms still active
extern const text::Entry kOverride;   ///< {0} per cent
extern const text::Entry kDown;
extern const text::Entry kObjectRead;

// the socket itself
extern const text::Entry kPathTooLong;
extern const text::Entry kAnotherListens;
extern const text::Entry kNoSocketFile;   ///< {0} path
extern const text::Entry kNoFolder;       ///< {0} folder
extern const text::Entry kForeignFolder;  ///< {0} folder

}  // namespace servogate::gateway::says
