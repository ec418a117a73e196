/* What the programs in C call of FMI 3.0. */
#ifndef FMU_HOST_3_H
#define FMU_HOST_3_H

#include "fmi3Functions.h"
#include "host.h"

#define FUNCTIONS_3(X) \
    X(GetVersion) X(SetDebugLogging) X(InstantiateModelExchange) X(InstantiateCoSimulation) \
    X(InstantiateScheduledExecution) X(FreeInstance) X(EnterInitializationMode) \
    X(ExitInitializationMode) X(EnterEventMode) X(Terminate) X(Reset) X(GetFloat32) X(GetFloat64) \
    X(GetInt8) X(GetUInt8) X(GetInt16) X(GetUInt16) X(GetInt32) X(GetUInt32) X(GetInt64) X(GetUInt64) \
    X(GetBoolean) X(GetString) X(GetBinary) X(GetClock) X(SetFloat32) X(SetFloat64) X(SetInt8) \
    X(SetUInt8) X(SetInt16) X(SetUInt16) X(SetInt32) X(SetUInt32) X(SetInt64) X(SetUInt64) \
    X(SetBoolean) X(SetString) X(SetBinary) X(SetClock) X(GetNumberOfVariableDependencies) \
    X(GetVariableDependencies) X(GetFMUState) X(SetFMUState) X(FreeFMUState) X(SerializedFMUStateSize) \
    X(SerializeFMUState) X(DeserializeFMUState) X(GetDirectionalDerivative) X(GetAdjointDerivative) \
    X(EnterConfigurationMode) X(ExitConfigurationMode) X(GetIntervalDecimal) X(GetIntervalFraction) \
    X(GetShiftDecimal) X(GetShiftFraction) X(SetIntervalDecimal) X(SetIntervalFraction) \
    X(SetShiftDecimal) X(SetShiftFraction) X(EvaluateDiscreteStates) X(UpdateDiscreteStates) \
    X(EnterContinuousTimeMode) X(CompletedIntegratorStep) X(SetTime) X(SetContinuousStates) \
    X(GetContinuousStateDerivatives) X(GetEventIndicators) X(GetContinuousStates) \
    X(GetNominalsOfContinuousStates) X(GetNumberOfEventIndicators) X(GetNumberOfContinuousStates) \
    X(EnterStepMode) X(GetOutputDerivatives) X(DoStep) X(ActivateModelPartition)

#define NUMBER_3(name) F3_##name,
enum function_3 { FUNCTIONS_3(NUMBER_3) FUNCTION_3_COUNT };
#define NAME_3(name) "fmi3" #name,
static const char *const NAMES_3[] = {FUNCTIONS_3(NAME_3)};
#define MEMBER_3(name) fmi3##name##TYPE *name;
static struct { FUNCTIONS_3(MEMBER_3) } fmu3;

/* Loads the functions; returns what is wrong, or a null pointer. */
static const char *load_3(const char *path) {
    void *library = open_library(path);
    if (!library) return loading_error();
#define LOAD_3(name) \
    if (!(fmu3.name = (fmi3##name##TYPE *)find_function(library, "fmi3" #name))) return "fmi3" #name " is missing";
    FUNCTIONS_3(LOAD_3)
    return NULL;
}

#endif
