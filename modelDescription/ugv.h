/* C interface of the FMU ugv: the functions of FMI 2.0 and the value references of the variables,
   for programs that load the library themselves. */

#ifndef UGV_H
#define UGV_H


/* The standard's types: https://fmi-standard.org/downloads */
#include "fmi2TypesPlatform.h"
#include "fmi2FunctionTypes.h"

/* Value references */
#define UGV_VR_OMEGA_LEFT 0u
#define UGV_VR_OMEGA_RIGHT 1u
#define UGV_VR_X 2u
#define UGV_VR_Y 3u
#define UGV_VR_HEADING 4u
#define UGV_VR_V_X 5u
#define UGV_VR_V_Y 6u
#define UGV_VR_YAW_RATE 7u
#define UGV_VR_A_X 8u
#define UGV_VR_A_Y 9u
#define UGV_VR_ROLLING_RESISTANCE 10u
#define UGV_VR_TURNING_RESISTANCE_MOMENT 11u
#define UGV_VR_TURNING_MOMENT 12u
#define UGV_VR_TORQUE_LEFT 13u
#define UGV_VR_TORQUE_RIGHT 14u
#define UGV_VR_POWER 15u
#define UGV_VR_DER_X 16u
#define UGV_VR_DER_Y 17u
#define UGV_VR_DER_HEADING 18u
#define UGV_VR_DER_V_X 19u
#define UGV_VR_DER_V_Y 20u
#define UGV_VR_DER_YAW_RATE 21u
#define UGV_VR_TERRAIN 22u
#define UGV_VR_SOIL_COHESION 23u
#define UGV_VR_SOIL_FRICTION_ANGLE_DEG 24u
#define UGV_VR_SOIL_COHESIVE_MODULUS 25u
#define UGV_VR_SOIL_FRICTIONAL_MODULUS 26u
#define UGV_VR_SOIL_SINKAGE_EXPONENT 27u
#define UGV_VR_SOIL_SHEAR_MODULUS 28u
#define UGV_VR_VEHICLE_MASS 29u
#define UGV_VR_VEHICLE_YAW_INERTIA 30u
#define UGV_VR_VEHICLE_WHEEL_RADIUS 31u
#define UGV_VR_VEHICLE_WHEEL_WIDTH 32u
#define UGV_VR_VEHICLE_HALF_TRACK 33u
#define UGV_VR_VEHICLE_COM_OFFSET 34u
#define UGV_VR_VEHICLE_COM_HEIGHT 35u
#define UGV_VR_INITIAL_X 36u
#define UGV_VR_INITIAL_Y 37u
#define UGV_VR_INITIAL_HEADING 38u
#define UGV_VR_INITIAL_V_X 39u
#define UGV_VR_INITIAL_V_Y 40u
#define UGV_VR_INITIAL_YAW_RATE 41u
#define UGV_VR_INITIAL_NO_SLIP 42u
#define UGV_VR_EFFECTS_GRADE_SLOPE_EAST 500u
#define UGV_VR_EFFECTS_GRADE_SLOPE_NORTH 501u
#define UGV_VR_EFFECTS_TERRAIN_CHANGE_COHESION_FACTOR 516u
#define UGV_VR_EFFECTS_TERRAIN_CHANGE_FRICTION_FACTOR 517u
#define UGV_VR_EFFECTS_TERRAIN_CHANGE_STIFFNESS_FACTOR 518u
#define UGV_VR_EFFECTS_TERRAIN_CHANGE_SHEAR_MODULUS_FACTOR 519u
#define UGV_VR_EFFECTS_TERRAIN_CHANGE_POSITION 520u
#define UGV_VR_EFFECTS_TERRAIN_CHANGE_DIRECTION 521u
#define UGV_VR_EFFECTS_TERRAIN_CHANGE_TRANSITION 522u
#define UGV_VR_EFFECTS_LEFT_RIGHT_SOIL_RATIO 532u
#define UGV_VR_EFFECTS_BULLDOZING_LATERAL 548u
#define UGV_VR_EFFECTS_BULLDOZING_FRONTAL 549u
#define UGV_VR_EFFECTS_BULLDOZING_UNIT_WEIGHT 550u
#define UGV_VR_EFFECTS_SLIP_SINKAGE_EXPONENT_GROWTH 564u
#define UGV_VR_EFFECTS_SLIP_SINKAGE_SINKAGE_GROWTH 565u
#define UGV_VR_EFFECTS_MULTIPASS_MEMORY 580u
#define UGV_VR_EFFECTS_MULTIPASS_STIFFNESS_RATIO 581u
#define UGV_VR_EFFECTS_ELASTIC_REBOUND_SHARE 596u
#define UGV_VR_EFFECTS_STRESS_PEAK_A0 612u
#define UGV_VR_EFFECTS_STRESS_PEAK_A1 613u
#define UGV_VR_EFFECTS_TYRE_COMPLIANCE_PRESSURE 628u
#define UGV_VR_EFFECTS_SHEAR_ANISOTROPY_MODULUS_RATIO 644u
#define UGV_VR_EFFECTS_SHEAR_ANISOTROPY_STRENGTH_RATIO 645u
#define UGV_VR_EFFECTS_TRANSIENT_SHEAR_RELAXATION 660u
#define UGV_VR_EFFECTS_RATE_DEPENDENT_SOIL_FORWARD 676u
#define UGV_VR_EFFECTS_RATE_DEPENDENT_SOIL_LATERAL 677u
#define UGV_VR_EFFECTS_DRAG_COEFFICIENT 692u
#define UGV_VR_EFFECTS_DRAWBAR_FORCE 708u
#define UGV_VR_EFFECTS_DRAWBAR_HITCH_BEHIND 709u
#define UGV_VR_EFFECTS_DRAWBAR_HITCH_HEIGHT 710u
#define UGV_VR_EFFECTS_PAYLOAD_MASS 724u
#define UGV_VR_EFFECTS_PAYLOAD_AHEAD 725u
#define UGV_VR_EFFECTS_PAYLOAD_LEFT 726u
#define UGV_VR_EFFECTS_PAYLOAD_HEIGHT 727u
#define UGV_VR_EFFECTS_COM_SHIFT_AHEAD 740u
#define UGV_VR_EFFECTS_COM_SHIFT_LEFT 741u
#define UGV_VR_EFFECTS_WHEEL_RADIUS_LEFT 756u
#define UGV_VR_EFFECTS_WHEEL_RADIUS_RIGHT 757u
#define UGV_VR_EFFECTS_RESIDUAL_LONGITUDINAL_CONSTANT 836u
#define UGV_VR_EFFECTS_RESIDUAL_LONGITUDINAL_DIRECTION 837u
#define UGV_VR_EFFECTS_RESIDUAL_LONGITUDINAL_SPEED 838u
#define UGV_VR_EFFECTS_RESIDUAL_LONGITUDINAL_SPEED_SQUARED 839u
#define UGV_VR_EFFECTS_RESIDUAL_LONGITUDINAL_TURNING 840u
#define UGV_VR_EFFECTS_RESIDUAL_LONGITUDINAL_TURNING_SQUARED 841u
#define UGV_VR_EFFECTS_RESIDUAL_LONGITUDINAL_SPEED_TURNING 842u
#define UGV_VR_EFFECTS_RESIDUAL_LONGITUDINAL_SIDEWAYS_TURNING 843u
#define UGV_VR_EFFECTS_RESIDUAL_LONGITUDINAL_SLIP 844u
#define UGV_VR_EFFECTS_RESIDUAL_LONGITUDINAL_SLIP_SQUARED 845u
#define UGV_VR_EFFECTS_RESIDUAL_LONGITUDINAL_EAST 846u
#define UGV_VR_EFFECTS_RESIDUAL_LONGITUDINAL_NORTH 847u
#define UGV_VR_EFFECTS_RESIDUAL_LATERAL_CONSTANT 852u
#define UGV_VR_EFFECTS_RESIDUAL_LATERAL_DIRECTION 853u
#define UGV_VR_EFFECTS_RESIDUAL_LATERAL_SIDEWAYS 854u
#define UGV_VR_EFFECTS_RESIDUAL_LATERAL_SIDEWAYS_SQUARED 855u
#define UGV_VR_EFFECTS_RESIDUAL_LATERAL_TURNING 856u
#define UGV_VR_EFFECTS_RESIDUAL_LATERAL_TURNING_SQUARED 857u
#define UGV_VR_EFFECTS_RESIDUAL_LATERAL_SPEED_TURNING 858u
#define UGV_VR_EFFECTS_RESIDUAL_LATERAL_SLIP 859u
#define UGV_VR_EFFECTS_RESIDUAL_LATERAL_EAST 860u
#define UGV_VR_EFFECTS_RESIDUAL_LATERAL_NORTH 861u
#define UGV_VR_EFFECTS_RESIDUAL_YAW_CONSTANT 868u
#define UGV_VR_EFFECTS_RESIDUAL_YAW_SPEED 869u
#define UGV_VR_EFFECTS_RESIDUAL_YAW_SPEED_SQUARED 870u
#define UGV_VR_EFFECTS_RESIDUAL_YAW_DIRECTION 871u
#define UGV_VR_EFFECTS_RESIDUAL_YAW_TURNING 872u
#define UGV_VR_EFFECTS_RESIDUAL_YAW_TURNING_SQUARED 873u
#define UGV_VR_EFFECTS_RESIDUAL_YAW_SPEED_TURNING 874u
#define UGV_VR_EFFECTS_RESIDUAL_YAW_SIDEWAYS 875u
#define UGV_VR_EFFECTS_RESIDUAL_YAW_SPEED_SIDEWAYS 876u
#define UGV_VR_EFFECTS_RESIDUAL_YAW_SLIP 877u
#define UGV_VR_EFFECTS_RESIDUAL_YAW_EAST 878u
#define UGV_VR_EFFECTS_RESIDUAL_YAW_NORTH 879u
/* Value references of row i and wheel i, counted from 1 */
#define UGV_VR_VEHICLE_ROW_POSITIONS(i) (1000u + 1u * ((i) - 1u))
#define UGV_VR_WHEEL_LONGITUDINAL_SLIP(i) (2000u + 16u * ((i) - 1u))
#define UGV_VR_WHEEL_LATERAL_SLIP(i) (2001u + 16u * ((i) - 1u))
#define UGV_VR_WHEEL_LOAD(i) (2002u + 16u * ((i) - 1u))
#define UGV_VR_WHEEL_SINKAGE(i) (2003u + 16u * ((i) - 1u))
#define UGV_VR_WHEEL_ENTRY_ANGLE(i) (2004u + 16u * ((i) - 1u))
#define UGV_VR_WHEEL_FORCE_X(i) (2005u + 16u * ((i) - 1u))
#define UGV_VR_WHEEL_FORCE_Y(i) (2006u + 16u * ((i) - 1u))
#define UGV_VR_WHEEL_TORQUE(i) (2007u + 16u * ((i) - 1u))
/* Soil under the wheels */
#define UGV_TERRAIN_DRY_SAND 1
#define UGV_TERRAIN_SANDY_LOAM 2
#define UGV_TERRAIN_CLAYED_SOIL 3
#define UGV_TERRAIN_DRY_CLAY 4
#define UGV_TERRAIN_CUSTOM 5


#ifdef __cplusplus
extern "C" {
#endif // __cplusplus

// The platform's types, `default`.
const char *fmi2GetTypesPlatform(void);

// The version of the standard, `2.0`.
const char *fmi2GetVersion(void);

// Creates an instance. On failure it logs the reason and returns null.
//
// # Safety
// As the standard requires: strings that end in zero, callbacks that outlive the instance.
fmi2Component fmi2Instantiate(fmi2String instance_name,
                              fmi2Type fmu_type,
                              fmi2String fmu_guid,
                              fmi2String fmu_resource_location,
                              const fmi2CallbackFunctions *functions,
                              fmi2Boolean _visible,
                              fmi2Boolean logging_on);

// Frees an instance. Null is allowed.
//
// # Safety
// `component` is null or a live component. It is invalid after the call.
void fmi2FreeInstance(fmi2Component component);

// Switches the logging of events and discarded calls on and off. Errors and warnings are always logged.
fmi2Status fmi2SetDebugLogging(fmi2Component component,
                               fmi2Boolean logging_on,
                               size_t n_categories,
                               const fmi2String *categories);

// Sets start and stop time.
fmi2Status fmi2SetupExperiment(fmi2Component component,
                               fmi2Boolean _tolerance_defined,
                               fmi2Real _tolerance,
                               fmi2Real start_time,
                               fmi2Boolean stop_time_defined,
                               fmi2Real stop_time);

// Enters initialization mode.
fmi2Status fmi2EnterInitializationMode(fmi2Component component);

// Exits initialization mode. From here on the parameters are fixed.
fmi2Status fmi2ExitInitializationMode(fmi2Component component);

// Ends the simulation. Values can still be read.
fmi2Status fmi2Terminate(fmi2Component component);

// Returns to the state after the instantiation.
fmi2Status fmi2Reset(fmi2Component component);

// Reads variables of type Real.
fmi2Status fmi2GetReal(fmi2Component component,
                       const fmi2ValueReference *references,
                       size_t count,
                       fmi2Real *values);

// Sets variables of type Real.
fmi2Status fmi2SetReal(fmi2Component component,
                       const fmi2ValueReference *references,
                       size_t count,
                       const fmi2Real *values);

// Reads variables of type Integer or of an enumeration.
fmi2Status fmi2GetInteger(fmi2Component component,
                          const fmi2ValueReference *references,
                          size_t count,
                          fmi2Integer *values);

// Sets variables of type Integer or of an enumeration.
fmi2Status fmi2SetInteger(fmi2Component component,
                          const fmi2ValueReference *references,
                          size_t count,
                          const fmi2Integer *values);

// Reads variables of type Boolean.
fmi2Status fmi2GetBoolean(fmi2Component component,
                          const fmi2ValueReference *references,
                          size_t count,
                          fmi2Boolean *values);

// Sets variables of type Boolean.
fmi2Status fmi2SetBoolean(fmi2Component component,
                          const fmi2ValueReference *references,
                          size_t count,
                          const fmi2Boolean *values);

// Reads variables of type String: there are none.
fmi2Status fmi2GetString(fmi2Component component,
                         const fmi2ValueReference *references,
                         size_t count,
                         fmi2String *_values);

// Sets variables of type String: there are none.
fmi2Status fmi2SetString(fmi2Component component,
                         const fmi2ValueReference *references,
                         size_t count,
                         const fmi2String *_values);

// Saves the state of the instance.
fmi2Status fmi2GetFMUstate(fmi2Component component, fmi2FMUstate *state);

// Returns to a saved state.
fmi2Status fmi2SetFMUstate(fmi2Component component, fmi2FMUstate state);

// Frees a saved state. Null is allowed.
fmi2Status fmi2FreeFMUstate(fmi2Component component, fmi2FMUstate *state);

// The number of bytes that `fmi2SerializeFMUstate` writes.
fmi2Status fmi2SerializedFMUstateSize(fmi2Component component, fmi2FMUstate state, size_t *size);

// Writes a saved state as bytes.
fmi2Status fmi2SerializeFMUstate(fmi2Component component,
                                 fmi2FMUstate state,
                                 fmi2Byte *serialized,
                                 size_t size);

// Makes a state from bytes.
fmi2Status fmi2DeSerializeFMUstate(fmi2Component component,
                                   const fmi2Byte *serialized,
                                   size_t size,
                                   fmi2FMUstate *state);

// Derivatives of outputs and state derivatives in a direction of inputs and states.
fmi2Status fmi2GetDirectionalDerivative(fmi2Component component,
                                        const fmi2ValueReference *unknown_references,
                                        size_t n_unknown,
                                        const fmi2ValueReference *known_references,
                                        size_t n_known,
                                        const fmi2Real *known_seeds,
                                        fmi2Real *unknown_values);

// Sets the rates at which the wheel speeds change during the next step.
fmi2Status fmi2SetRealInputDerivatives(fmi2Component component,
                                       const fmi2ValueReference *references,
                                       size_t count,
                                       const fmi2Integer *orders,
                                       const fmi2Real *values);

// The first derivatives of outputs in time.
fmi2Status fmi2GetRealOutputDerivatives(fmi2Component component,
                                        const fmi2ValueReference *references,
                                        size_t count,
                                        const fmi2Integer *orders,
                                        fmi2Real *values);

// Simulates one communication step.
fmi2Status fmi2DoStep(fmi2Component component,
                      fmi2Real current_communication_point,
                      fmi2Real communication_step_size,
                      fmi2Boolean _no_set_fmu_state_prior_to_current_point);

// Not available: steps are never asynchronous.
fmi2Status fmi2CancelStep(fmi2Component component);

// Not available: steps are never asynchronous.
fmi2Status fmi2GetStatus(fmi2Component component, fmi2StatusKind kind, fmi2Status *_value);

// The time that the last step reached.
fmi2Status fmi2GetRealStatus(fmi2Component component, fmi2StatusKind kind, fmi2Real *value);

// Not available: there is no such status.
fmi2Status fmi2GetIntegerStatus(fmi2Component component, fmi2StatusKind kind, fmi2Integer *_value);

// Whether the FMU asks to end the simulation: it never does.
fmi2Status fmi2GetBooleanStatus(fmi2Component component, fmi2StatusKind kind, fmi2Boolean *value);

// Not available: steps are never asynchronous.
fmi2Status fmi2GetStringStatus(fmi2Component component, fmi2StatusKind kind, fmi2String *_value);

// Enters event mode.
fmi2Status fmi2EnterEventMode(fmi2Component component);

// Handles an event. Effects with a time window switch here; the result holds the next such time.
fmi2Status fmi2NewDiscreteStates(fmi2Component component, fmi2EventInfo *event_info);

// Enters continuous-time mode.
fmi2Status fmi2EnterContinuousTimeMode(fmi2Component component);

// Completes an integrator step. The model never asks for an event.
fmi2Status fmi2CompletedIntegratorStep(fmi2Component component,
                                       fmi2Boolean _no_set_fmu_state_prior_to_current_point,
                                       fmi2Boolean *enter_event_mode,
                                       fmi2Boolean *terminate_simulation);

// Sets the time. Only effects depend on it.
fmi2Status fmi2SetTime(fmi2Component component, fmi2Real time);

// Sets the states.
fmi2Status fmi2SetContinuousStates(fmi2Component component, const fmi2Real *states, size_t count);

// The derivatives of the states.
fmi2Status fmi2GetDerivatives(fmi2Component component, fmi2Real *derivatives, size_t count);

// Event indicators: there are none.
fmi2Status fmi2GetEventIndicators(fmi2Component component, fmi2Real *_indicators, size_t count);

// The states.
fmi2Status fmi2GetContinuousStates(fmi2Component component, fmi2Real *states, size_t count);

// Orders of magnitude of the states.
fmi2Status fmi2GetNominalsOfContinuousStates(fmi2Component component,
                                             fmi2Real *nominals,
                                             size_t count);

#ifdef __cplusplus
}  // extern "C"
#endif  // __cplusplus

#endif  /* UGV_H */
