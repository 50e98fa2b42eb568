// Where a path is at waypoints and during contacts.
import { contactsOf, fieldsOf, waypointsOf } from "./data.js";

const contactSteps = 64;

/** Of a body on the path in front: a place for each waypoint, a list of places for each contact. */
export function marks(state, trajectory, body) {
  const fields = fieldsOf(state.data, state.selected);
  const place = (time) => body.columns.map((number) => trajectory.at(number, time));
  const part = ({ from, to }) =>
    Array.from({ length: contactSteps + 1 }, (_, k) => place(from + ((to - from) * k) / contactSteps));
  return {
    waypoints: waypointsOf(fields).map(({ t }) => place(t)),
    contacts: contactsOf(fields).map(part),
  };
}
