//! What the methods for scans are from.

use linden_skeleton::publication::{Publication, PublicationKind};

/// Axes through the middles of points that are as far from the foot.
pub(crate) const VERROUST_LAZARUS: Publication = Publication {
    key: "verroust1999",
    kind: PublicationKind::InProceedings,
    authors: &["Verroust, Anne", "Lazarus, Francis"],
    title: "Extracting Skeletal Curves from 3D Scattered Data",
    year: 1999,
    venue: "International Conference on Shape Modeling and Applications",
    volume: "",
    number: "",
    pages: "194-201",
};

/// The same of trees.
pub(crate) const XU_GOSSETT_CHEN: Publication = Publication {
    key: "xu2007",
    kind: PublicationKind::Article,
    authors: &["Xu, Hui", "Gossett, Nathan", "Chen, Baoquan"],
    title: "Knowledge and Heuristic-Based Modeling of Laser-Scanned Trees",
    year: 2007,
    venue: "ACM Transactions on Graphics",
    volume: "26",
    number: "4",
    pages: "19",
};

/// The ground below the points of a plot.
pub(crate) const ZHANG: Publication = Publication {
    key: "zhang2016",
    kind: PublicationKind::Article,
    authors: &[
        "Zhang, Wuming",
        "Qi, Jianbo",
        "Wan, Peng",
        "Wang, Hongtao",
        "Xie, Donghui",
        "Wang, Xiaoyan",
        "Yan, Guangjian",
    ],
    title: "An Easy-to-Use Airborne LiDAR Data Filtering Method Based on Cloth Simulation",
    year: 2016,
    venue: "Remote Sensing",
    volume: "8",
    number: "6",
    pages: "501",
};

/// To which stem the points of a plot belong.
pub(crate) const TAO: Publication = Publication {
    key: "tao2015",
    kind: PublicationKind::Article,
    authors: &[
        "Tao, S.", "Wu, F.", "Guo, Q.", "Wang, Y.", "Li, W.", "Xue, B.", "Hu, X.", "Li, P.", "Tian, D.",
        "Li, C.", "Yao, H.", "Li, Y.", "Xu, G.", "Fang, J.",
    ],
    title: "Segmenting tree crowns from terrestrial and mobile LiDAR data by exploring ecological theories",
    year: 2015,
    venue: "ISPRS Journal of Photogrammetry and Remote Sensing",
    volume: "110",
    number: "",
    pages: "66-76",
};

/// Which points lie on leaves, by the ways that lead through them.
pub(crate) const VICARI: Publication = Publication {
    key: "vicari2019",
    kind: PublicationKind::Article,
    authors: &[
        "Vicari, Matheus B.",
        "Disney, Mathias",
        "Wilkes, Phil",
        "Burt, Andrew",
        "Calders, Kim",
        "Woodgate, William",
    ],
    title: "Leaf and wood classification framework for terrestrial LiDAR point clouds",
    year: 2019,
    venue: "Methods in Ecology and Evolution",
    volume: "10",
    number: "5",
    pages: "680-694",
};

/// How thick wood is likely that bears so much: what is as thick is told from leaves by it.
pub(crate) const DU: Publication = Publication {
    key: "du2019",
    kind: PublicationKind::Article,
    authors: &["Du, Shenglan", "Lindenbergh, Roderik", "Ledoux, Hugo", "Stoter, Jantien", "Nan, Liangliang"],
    title: "AdTree: Accurate, Detailed, and Automatic Modelling of Laser-Scanned Trees",
    year: 2019,
    venue: "Remote Sensing",
    volume: "11",
    number: "18",
    pages: "2074",
};

#[cfg(test)]
mod tests {
    use linden_skeleton::generator::Settings as _;

    use crate::{LeafPoints, ScanSettings, Segmentation};

    #[test]
    fn what_knobs_ask_for_is_cited() {
        let keys = |segmentation, leaf_points| {
            let settings = ScanSettings { segmentation, leaf_points, ..ScanSettings::of("plot.laz") };
            settings.publications().iter().map(|publication| publication.key).collect::<Vec<_>>()
        };
        let usual = ["runions2007", "verroust1999", "xu2007"];
        assert_eq!(keys(Segmentation::Column, LeafPoints::Auto), usual);
        let plot = keys(Segmentation::Paths, LeafPoints::None);
        assert_eq!(plot, [&usual[..], &["zhang2016", "tao2015"]].concat());
        let leafy = keys(Segmentation::Column, LeafPoints::Paths);
        assert_eq!(leafy, [&usual[..], &["vicari2019", "du2019"]].concat());
        assert_eq!(keys(Segmentation::Paths, LeafPoints::Paths).len(), 7);
    }
}
