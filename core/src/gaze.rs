//! What the gaze is worth at this moment: tracked, held, lost; fixating or in a saccade.
