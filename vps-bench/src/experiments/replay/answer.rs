//! Judging an answer about a pose.

/// Reported and true penetration at a pose, in metres.
#[derive(Clone, Copy, Debug)]
pub(super) struct Answer {
    /// Penetration of the deepest contact; `None` without a contact.
    pub(super) reported: Option<f64>,
    pub(super) truth: f64,
}

impl Answer {
    /// Reported minus true penetration; negative if the truth is deeper.
    pub(super) fn error(self) -> Option<f64> {
        self.reported.map(|reported| reported - self.truth)
    }

    fn touches(self) -> bool {
        self.reported.is_some_and(|penetration| penetration >= 0.0)
    }

    /// Whether the bodies overlap by more than the tolerance and no touch was found.
    pub(super) fn is_missed(self, tolerance: f64) -> bool {
        self.truth > tolerance && !self.touches()
    }

    /// Whether they are apart by more than the tolerance and a touch was found.
    pub(super) fn is_false_touch(self, tolerance: f64) -> bool {
        self.truth < -tolerance && self.touches()
    }

    /// Whether they are closer than the prediction by more than the tolerance and no contact was
    /// reported.
    pub(super) fn is_silent(self, prediction: f64, tolerance: f64) -> bool {
        self.truth > tolerance - prediction && self.reported.is_none()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_are_positive_if_reported_too_deep() {
        let answer = |reported, truth| Answer { reported, truth };
        assert_eq!(answer(Some(3.0), 1.0).error(), Some(2.0));
        assert_eq!(answer(Some(-3.0), -1.0).error(), Some(-2.0));
        assert_eq!(answer(None, 1.0).error(), None);
    }

    #[test]
    fn an_overlap_without_a_touch_is_missed() {
        let is_missed = |reported, truth| Answer { reported, truth }.is_missed(0.1);
        assert!(is_missed(None, 0.2) && is_missed(Some(-0.01), 0.2));
        assert!(!is_missed(Some(0.0), 0.2) && !is_missed(None, 0.1) && !is_missed(None, -5.0));
        let is_false = |reported, truth| Answer { reported, truth }.is_false_touch(0.1);
        assert!(is_false(Some(0.0), -0.2));
        assert!(!is_false(Some(0.0), -0.1) && !is_false(None, -0.2));
        assert!(!is_false(Some(-0.01), -0.2));
    }

    #[test]
    fn bodies_within_the_prediction_need_a_contact() {
        let is_silent = |reported, truth| Answer { reported, truth }.is_silent(2.0, 0.1);
        assert!(is_silent(None, -1.8) && is_silent(None, 1.0));
        assert!(!is_silent(None, -1.95) && !is_silent(Some(-1.0), -1.8));
    }
}
